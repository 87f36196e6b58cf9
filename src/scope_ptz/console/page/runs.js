// The run library: search runs, view and compare frames, download runs, and read or give feedback.

import { get, part, url } from "./api.js";
import { emit, on, shared } from "./app_state.js";
import { openDrafts } from "./drafts.js";
import { feedbackButtons } from "./feedback.js";
import { h, icon, iconButton, seconds } from "./dom.js";
import { PARTS, legend, tools } from "./timings.js";
import { OUTCOMES } from "./turn.js";

const WIDE = 2.2; // pictures with a larger aspect ratio are panoramas

export function makeRuns() {
  const search = h("input", { type: "search", placeholder: "Search instructions and answers", "aria-label": "Search runs" });
  const rating = choice("Feedback", [["", "Any feedback"], ["good", "Good"], ["bad", "Bad"]]);
  const outcome = choice("Outcome", [["", "Any outcome"], ...Object.entries(OUTCOMES)]);
  const every = h("input", { type: "checkbox", id: "all-cameras" });
  const list = h("ul", { className: "run-list" }), more = h("button", { type: "button", className: "link", hidden: true, onclick: () => load(next) }, "More");
  const exports = h("div", { className: "row" }, h("span", { className: "muted" }, "Export these runs:"), ...[["jsonl", "data"], ["chat", "fine-tuning"], ["zip", "folders"]]
    .map(([form, name]) => h("a", { href: "#", onclick: (event) => { event.preventDefault(); location.assign(url(`/runs/export?format=${form}&${query().replace(/&?kind=[^&]*/, "")}`)); } }, name)),
    h("button", { type: "button", className: "link underlined", title: "Drafts of benchmark tasks, from runs with good feedback", onclick: () => openDrafts(query().replace(/&?rating=[^&]*/, "")) }, "task drafts"));
  const detail = h("div", { className: "detail" }, h("p", { className: "empty" }, "Choose a run to see its frames."));
  const element = h("section", { className: "page runs", "aria-label": "Runs", hidden: true },
    h("div", { className: "finder" }, search, h("div", { className: "row" }, rating, outcome),
      h("label", { className: "check", htmlFor: "all-cameras" }, every, "All cameras"), list, more, exports), detail);
  let next = null, timer = 0, chosen = "", requests = 0;

  function query() {
    const parameters = new URLSearchParams();
    if (search.value.trim()) parameters.set("text", search.value.trim());
    if (rating.value) parameters.set("rating", rating.value);
    if (outcome.value) parameters.set("outcome", outcome.value);
    if (!every.checked && shared.camera) parameters.set("camera", shared.camera);
    return parameters.toString();
  }

  async function load(after = null) {
    if (element.hidden) return;
    const request = ++requests;
    try {
      const page = await get(`/runs?${query()}&limit=40${after ? `&after=${part(after)}` : ""}`);
      if (request !== requests) return; // a later request has replaced this one
      if (!after) list.replaceChildren();
      list.append(...page.runs.map(entry));
      if (!list.childNodes.length) list.append(h("li", { className: "empty" }, query() ? "No run matches the search." : "No runs yet."));
      next = page.next;
      more.hidden = !next;
    } catch (error) {
      list.replaceChildren(h("li", { className: "problem" }, error.message));
    }
  }

  function entry(run) {
    const when = new Date(run.started).toLocaleString([], { dateStyle: "short", timeStyle: "short" });
    const votes = run.thumbs_up || run.thumbs_down ? ` · ${run.thumbs_up ? `+${run.thumbs_up}` : ""}${run.thumbs_down ? ` −${run.thumbs_down}` : ""}` : "";
    return h("li", {}, h("button", { type: "button", "aria-pressed": String(run.id === chosen), value: run.id, onclick: () => open(run.id) },
      h("span", { className: "what" }, run.instruction),
      h("span", { className: "when" }, `${when} · ${OUTCOMES[run.outcome] ?? run.outcome} · ${seconds(run.total_s)}${votes}`)));
  }

  async function open(id) {
    chosen = id;
    for (const each of list.querySelectorAll("button")) each.setAttribute("aria-pressed", String(each.value === id));
    detail.replaceChildren(h("p", { className: "empty" }, "Loading …"));
    try {
      const [details, pictures] = await Promise.all([get(`/runs/${part(id)}/details`), get(`/runs/${part(id)}/pictures`)]);
      if (chosen === id) detail.replaceChildren(...describe(details, pictures));
    } catch (error) {
      if (chosen === id) detail.replaceChildren(h("p", { className: "problem" }, error.message));
    }
  }

  for (const each of [rating, outcome, every]) each.addEventListener("change", () => load());
  search.addEventListener("input", () => { clearTimeout(timer); timer = setTimeout(load, 250); });
  on("show", (name) => { element.hidden = name !== "runs"; load(); });
  on("open run", (id) => { emit("go", "runs"); open(id); });
  on("run ended", () => setTimeout(load, 300));
  on("camera", () => load());
  return element;
}

function choice(label, options) {
  return h("select", { "aria-label": label }, options.map(([value, name]) => h("option", { value }, name)));
}

function describe({ run, feedback }, pictures) {
  const marked = h("input", { type: "checkbox", id: "with-marks", checked: true });
  const compared = [];
  const grid = h("ul", { className: "gallery" });
  const viewer = makeViewer(run.id, pictures, marked);
  const pair = h("button", { type: "button", hidden: true, onclick: () => viewer.open(compared[0], compared[1]) }, "Compare the two");
  const draw = () => grid.replaceChildren(...pictures.map((picture, index) => {
    const pick = h("input", { type: "checkbox", "aria-label": `Compare picture ${index + 1}`, checked: compared.includes(index), onchange: () => {
      if (pick.checked) compared.push(index); else compared.splice(compared.indexOf(index), 1);
      if (compared.length > 2) compared.shift();
      pair.hidden = compared.length !== 2;
      draw();
    } });
    return h("li", {}, h("button", { type: "button", onclick: () => viewer.open(index) },
      h("img", { alt: picture.message || "The view at the start", loading: "lazy", src: source(run.id, picture, marked.checked) })),
    h("p", {}, pick, h("span", {}, picture.tool ? `${picture.tool.replaceAll("_", " ")}${picture.marks.length ? ` · ${picture.marks.length}` : ""}` : "start")));
  }));
  marked.addEventListener("change", draw);
  draw();
  return [h("h1", {}, run.instruction), h("p", { className: "lead" }, run.answer),
    h("div", { className: "row" }, ...feedbackButtons(run.id), h("span", { className: "muted" }, `${run.planner} + ${run.perception} · ${run.steps} steps · ${run.calls} calls · ${seconds(run.total_s)}`)),
    total(run), legend(),
    h("div", { className: "row" }, h("h2", {}, "Frames"), h("label", { className: "check", htmlFor: "with-marks" }, marked, "Marks"), h("span", { className: "space" }), pair,
      pictures.length > 1 && h("button", { type: "button", onclick: () => viewer.open(0) }, "Replay")),
    pictures.length ? grid : h("p", { className: "empty" }, "This run took no pictures."),
    feedback.length > 0 && h("h2", {}, "Feedback"),
    h("ul", { className: "words" }, feedback.map((each) => h("li", {}, icon(each.rating > 0 ? "good" : each.rating < 0 ? "bad" : "note"),
      `${each.actor}${each.position === null ? "" : `, step ${each.position + 1}`}: ${each.comment || (each.rating > 0 ? "good" : "bad")}`)))].filter(Boolean);
}

function total(run) {
  return h("div", { className: "split", role: "img", "aria-label": PARTS.map(([key, name]) => `${name} ${seconds(key === "tools_s" ? tools(run) : run[key])}`).join(", ") },
    PARTS.map(([key, name]) => {
      const value = key === "tools_s" ? tools(run) : run[key];
      const block = h("i", { className: key, title: `${name} ${seconds(value)}` });
      block.style.flexGrow = String(value);
      return block;
    }));
}

const source = (run, picture, marks) => url(`/runs/${part(run)}/pictures/${picture.name}${marks ? "?marks=true" : ""}`);

// One picture, or two side by side. Panoramas can be dragged.
function makeViewer(run, pictures, marked) {
  let index = 0, other = null;
  const body = h("div", { className: "pictures" }), text = h("p", {});
  const dialog = h("dialog", { className: "viewer", "aria-label": "Picture", onclose: () => dialog.remove() },
    h("div", { className: "row" }, text, h("span", { className: "space" }), iconButton("left", "Previous picture (←)", () => show(index - 1)),
      iconButton("right", "Next picture (→)", () => show(index + 1)), iconButton("save", "Download", download), iconButton("close", "Close", () => dialog.close())), body);
  dialog.addEventListener("keydown", (event) => {
    if (event.key === "ArrowLeft") show(index - 1);
    if (event.key === "ArrowRight") show(index + 1);
  });

  function show(to) {
    index = (to + pictures.length) % pictures.length;
    const both = other === null ? [index] : [index, other];
    text.textContent = both.map((each) => `${each + 1}/${pictures.length} ${pictures[each].message || "The view at the start"}`).join("  |  ");
    body.className = `pictures${both.length > 1 ? " two" : ""}`;
    body.replaceChildren(...both.map((each) => draggable(h("img", { alt: pictures[each].message || "The view at the start", draggable: false, src: source(run, pictures[each], marked.checked) }))));
  }

  function download() {
    const picture = pictures[index];
    h("a", { href: source(run, picture, marked.checked), download: `${run}-${picture.name.split("/").at(-1)}` }).click();
  }

  return { open(first, second = null) {
    other = second;
    document.querySelector("#scope").append(dialog);
    if (!dialog.open) dialog.showModal();
    show(first);
  } };
}

function draggable(image) {
  const frame = h("div", { className: "scroll" }, image);
  image.addEventListener("load", () => frame.classList.toggle("wide", image.naturalWidth / image.naturalHeight > WIDE));
  frame.addEventListener("pointermove", (event) => { if (event.buttons) frame.scrollLeft -= event.movementX; });
  return frame;
}
