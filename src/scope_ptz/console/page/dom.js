// Elements, icons, dialogs and notices. Text is always inserted as text, never as HTML.

const SVG = "http://www.w3.org/2000/svg";
const ICONS = {
  stop: "M7 7h10v10H7z",
  home: "M4 11l8-7 8 7M6 10v9h12v-9",
  undo: "M9 7L4 12l5 5M4 12h10a5 5 0 0 1 0 10h-2",
  plus: "M12 5v14M5 12h14",
  minus: "M5 12h14",
  up: "M6 15l6-6 6 6", down: "M6 9l6 6 6-6", left: "M15 6l-6 6 6 6", right: "M9 6l6 6-6 6",
  good: "M7 11v9H4v-9zm0 0l4-8c2 0 2.5 1.5 2 3.5L12.500 10H19c1 0 1.500 1 1.200 2l-1.700 6.500c-.3 1-1 1.500-2 1.500H7",
  bad: "M17 13V4h3v9zm0 0l-4 8c-2 0-2.500-1.500-2-3.500l.5-3.500H5c-1 0-1.500-1-1.200-2l1.700-6.500C5.800 4.500 6.500 4 7.500 4H17",
  note: "M4 5h16v11H9l-5 4z",
  theme: "M12 4a8 8 0 1 0 0 16zM12 4a8 8 0 0 1 0 16",
  pencil: "M5 19l1-4L16 5l3 3L9 18z", trash: "M5 7h14M10 7V4h4v3M7 7l1 13h8l1-13",
  save: "M12 4v11M7 10l5 5 5-5M5 20h14", send: "M4 12l16-8-6 16-3-7z", close: "M6 6l12 12M18 6L6 18",
  pause: "M8 6v12M16 6v12", play: "M8 5l11 7-11 7z", clock: "M12 4a8 8 0 1 0 0 16 8 8 0 0 0 0-16zM12 8v4l3 2",
  back: "M12 6l-7 6 7 6zM19 6l-7 6 7 6z", ahead: "M12 6l7 6-7 6zM5 6l7 6-7 6z", copy: "M9 9h10v10H9zM15 9V5H5v10h4",
  camera: "M4 8h4l2-3h4l2 3h4v11H4zM12 10a3.500 3.500 0 1 0 0 7 3.500 3.500 0 0 0 0-7z",
  eye: "M2 12s4-7 10-7 10 7 10 7-4 7-10 7S2 12 2 12zM12 9a3 3 0 1 0 0 6 3 3 0 0 0 0-6z",
};

export function h(tag, props = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(props)) {
    if (value === undefined || value === null || value === false) continue;
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (name in element && !name.includes("-") && name !== "list" && name !== "role") element[name] = value;
    else element.setAttribute(name, value === true ? "" : value);
  }
  element.append(...children.flat().filter((each) => each !== null && each !== undefined && each !== false));
  return element;
}

export function svg(tag, attributes = {}, ...children) {
  const element = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

export function icon(name) {
  return svg("svg", { viewBox: "0 0 24 24", class: "icon", "aria-hidden": "true" }, svg("path", { d: ICONS[name] }));
}

export function iconButton(name, label, onclick, props = {}) {
  return h("button", { type: "button", className: "quiet", title: label, "aria-label": label, onclick, ...props }, icon(name));
}

let notices;

export function setNoticeArea(element) {
  notices = element;
}

// Show a message for 9 seconds. `action` is [label, function].
export function notify(message, action = null) {
  if (!notices) return;
  const box = h("div", { className: "notice" }, h("span", {}, message));
  if (action) box.append(h("button", { type: "button", onclick: () => { box.remove(); action[1](); } }, action[0]));
  box.append(iconButton("close", "Close this message", () => box.remove()));
  notices.replaceChildren(box);
  setTimeout(() => box.remove(), 9000);
}

// Ask for one line of text, or for a confirmation if `value` is undefined. Resolves to null if the user cancels.
export function askFor({ title, label = "", value, confirm = "Save", maxLength = 31 }) {
  return new Promise((resolve) => {
    const input = value === undefined ? null
      : h("input", { type: "text", value, maxLength, required: maxLength <= 31, "aria-label": label || title });
    const dialog = h("dialog", { "aria-label": title, onclose: () => {
      resolve(dialog.returnValue === "yes" ? (input ? input.value.trim() : "yes") : null);
      dialog.remove();
    } }, h("form", { method: "dialog" }, h("h2", {}, title), label && h("p", {}, label), input,
      h("div", { className: "row end" },
        h("button", { type: "button", onclick: () => dialog.close("") }, "Cancel"),
        h("button", { className: "primary", value: "yes" }, confirm))));
    document.querySelector("#scope").append(dialog);
    dialog.showModal();
    input?.select();
  });
}

export const seconds = (value) => (value < 0.0095 ? "0.01 s" : value < 10 ? `${value.toFixed(2)} s` : `${value.toFixed(0)} s`);
