// The switch of a scene's virtual camera, with the addresses and the account. The password is shown only once.

import { command } from "./api.js";
import { h, iconButton, notify } from "./dom.js";

const ADDRESSES = [["VAPIX", "vapix_url"], ["ONVIF", "onvif_url"], ["RTSP", "rtsp_url"]];

export function makeVirtualCamera(camera, viewpoints) {
  const state = h("button", { type: "button", role: "switch", className: "switch", "aria-label": `Virtual camera of ${camera}`, onclick: flip }, h("i", {}));
  const place = h("select", { "aria-label": `Viewpoint of the virtual camera of ${camera}` }, viewpoints.map((name) => h("option", { value: name }, name)));
  const hint = h("p", { className: "hint" }), facts = h("dl", { className: "addresses" });
  const element = h("div", { className: "virtual", role: "group", "aria-label": `Virtual camera of ${camera}` },
    h("div", { className: "row" }, h("h3", {}, "Virtual camera"), h("span", { className: "space" }), viewpoints.length > 1 && place, state), hint, facts);
  let shown = "", password = null, busy = false;

  async function flip() {
    if (busy) return;
    busy = state.disabled = true;
    hint.textContent = state.getAttribute("aria-checked") === "true" ? "Turning it off …" : "Starting …";
    const off = state.getAttribute("aria-checked") === "true";
    const reply = off ? await command(camera, "/virtual", undefined, "DELETE") : await command(camera, "/virtual", viewpoints.length ? { viewpoint: place.value } : {});
    busy = state.disabled = false;
    shown = "";
    if (reply === undefined) { update(last); return; }
    password = off ? null : reply.password;
    update(off ? { on: false } : { ...reply, password: null });
    state.focus();
  }

  let last = { on: false };
  function update(model) {
    if (busy) return;
    last = model;
    if (!model.on) password = null;
    const key = JSON.stringify([model, password]);
    if (key === shown) return;
    shown = key;
    state.setAttribute("aria-checked", model.on);
    place.hidden = model.on;
    hint.textContent = model.on
      ? `On, at ${model.viewpoint}. Programs on the server's machine can use it.`
      : "Serve this scene as a network camera, for other programs on the server's machine.";
    facts.replaceChildren(...(model.on ? [...ADDRESSES.map(([name, field]) => line(name, model[field])), line("Account", model.account),
      password ? line("Password", password, "Copy it now: it is shown only once.") : note("Password", "It was shown when the camera was turned on. To get a new password, turn the camera off and on.")] : []));
  }

  return { element, update };
}

function line(name, text, warning = "") {
  return h("div", {}, h("dt", {}, name), h("dd", {}, h("code", {}, text), iconButton("copy", `Copy: ${name}`, () => copy(text)), warning && h("small", {}, warning)));
}

const note = (name, text) => h("div", {}, h("dt", {}, name), h("dd", { className: "muted" }, text));

async function copy(text) {
  try {
    await navigator.clipboard.writeText(text);
    notify("Copied.");
  } catch {
    notify("The browser does not allow copying here. Select the text instead.");
  }
}
