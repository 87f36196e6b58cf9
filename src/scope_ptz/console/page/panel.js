// The language panel: a conversation with the camera. The server executes the instructions; the panel shows their progress.

import { get, part, post } from "./api.js";
import { emit, on, shared } from "./app_state.js";
import { h, icon, notify } from "./dom.js";
import { makeTurn } from "./turn.js";

const HEALTH = { built_in: "built in", ready: "ready", unreachable: "unreachable", not_configured: "not configured" };

export function makePanel() {
  const thread = h("div", { className: "thread", tabIndex: 0, role: "log", "aria-label": "Conversation" });
  const text = h("textarea", { rows: 2, maxLength: 2000, placeholder: "What should the camera do?", "aria-label": "Instruction" });
  const send = h("button", { className: "primary send", title: "Send (Enter)", "aria-label": "Send" }, icon("send"));
  const cancel = h("button", { type: "button", className: "cancel", hidden: true, onclick: stop }, "Cancel");
  const first = h("input", { type: "checkbox", id: "preview-first" });
  const pair = h("select", { "aria-label": "Planner and perception", onchange: () => showHealth() });
  const health = h("p", { className: "health" });
  const form = h("form", { className: "composer", onsubmit: (event) => { event.preventDefault(); submit(); } }, text,
    h("div", { className: "row" }, h("label", { htmlFor: "preview-first", className: "check", title: "Show the moves before the camera makes them" }, first, "Preview first"),
      h("span", { className: "space" }), cancel, send));
  const newButton = h("button", { type: "button", className: "link", title: "Start a new conversation", onclick: begin }, icon("plus"), "New");
  const element = h("aside", { className: "panel", "aria-label": "Instructions" },
    h("div", { className: "row head" }, pair, health, h("span", { className: "space" }), newButton), thread, form);
  const shown = new Map(); // turns by run id
  let conversation = null, restores = 0;
  let ready = false, early = false; // whether the conversation has been loaded; whether an instruction was entered before that

  text.addEventListener("keydown", (event) => {
    if (event.key === "Enter" && !event.shiftKey && !event.isComposing) { event.preventDefault(); submit(); }
  });

  const key = () => `scope-conversation-${shared.camera}`;

  function suggestions() {
    const names = shared.state?.presets.map((each) => each.name) ?? [];
    const simulated = shared.state?.simulated;
    const ideas = [names[0] && `Go to the ${names[0]} preset`, names[1] && `Go to the ${names[1]} preset and zoom in 2x`,
      simulated && "How many people are there?", "Pan right by 30 degrees", "Zoom in 2x", simulated && "Find a person and zoom in on them"].filter(Boolean);
    return h("div", { className: "empty" }, h("h2", {}, "Tell the camera what to do"),
      h("p", {}, "Write an instruction in plain language, or click in the picture to turn the camera there. Examples:"),
      h("div", { className: "chips" }, ideas.map((idea) => h("button", { type: "button", className: "chip", onclick: () => { text.value = idea; submit(); } }, idea))));
  }

  function add(run, options) {
    if (run.id && shown.has(run.id)) return shown.get(run.id);
    thread.querySelector(".empty")?.remove();
    // The server may announce a preview before it replies to the request that started it, so every turn gets `onConfirm`.
    const turn = makeTurn(run, { ...options, onConfirm: (instruction) => start(instruction, false) });
    if (run.id) shown.set(run.id, turn);
    turn.element.addEventListener("grown", follow);
    thread.append(turn.element);
    follow();
    return turn;
  }

  function follow() {
    thread.scrollTop = thread.scrollHeight;
  }

  async function submit() {
    const instruction = text.value.trim();
    if (!instruction) return;
    if (!ready) { early = true; return; }
    if (shared.running) {
      notify("An instruction is in progress. Send this one when it has ended.", ["Cancel the one in progress", stop]);
      return;
    }
    text.value = "";
    await start(instruction, first.checked);
  }

  async function start(instruction, dry) {
    emit("marks", null);
    try {
      if (!conversation) await create();
      const run = await post("/runs", { camera: shared.camera, instruction, conversation, pair: pair.value, dry_run: dry });
      busy(run.id);
      add(run, { live: !dry, kind: run.kind, onEnd: ended });
    } catch (error) {
      add({ instruction }, {}).fail(error.message);
    }
  }

  async function create() {
    conversation = (await post("/conversations", { camera: shared.camera, pair: pair.value })).id;
    localStorage.setItem(key(), conversation);
  }

  function begin() {
    localStorage.removeItem(key());
    conversation = null;
    clear();
    thread.replaceChildren(suggestions());
    text.focus();
  }

  function clear() {
    for (const turn of shown.values()) turn.close?.();
    shown.clear();
    thread.replaceChildren();
  }

  function busy(run) {
    shared.running = run;
    cancel.hidden = !run;
    send.disabled = Boolean(run);
    element.classList.toggle("busy", Boolean(run));
  }

  function ended() {
    busy(null);
    emit("run ended");
  }

  async function stop() {
    if (shared.running) await post(`/runs/${part(shared.running)}/cancel`).catch((error) => notify(error.message));
  }

  // Show a run that this page did not start, for example after a reload or from another browser.
  async function attach(id) {
    if (shown.has(id)) return;
    const run = await get(`/runs/${part(id)}`).catch(() => null);
    if (run && run.kind !== "tool" && run.camera === shared.camera) add(run, { live: run.kind === "instruction", kind: run.kind, onEnd: ended });
  }

  async function restore() {
    const restoreNumber = ++restores;
    clear();
    conversation = localStorage.getItem(key());
    if (conversation) {
      const page = await get(`/runs?conversation=${part(conversation)}&limit=20`).catch(() => null);
      if (restoreNumber !== restores) return; // a later call has replaced this one
      if (!page) conversation = null;
      for (const run of (page?.runs ?? []).reverse()) add(run, { kind: run.kind, live: run.id === shared.running, onEnd: ended });
    }
    if (!thread.childNodes.length) thread.replaceChildren(suggestions());
    if (shared.running) attach(shared.running);
    ready = true;
    if (early) { early = false; submit(); }
  }

  async function showHealth() {
    const name = pair.value;
    health.replaceChildren();
    const models = await get(`/pairs/${part(name)}/health`).catch(() => null);
    if (!models || name !== pair.value) return;
    const bad = [models.planner, models.perception].filter((each) => !["ready", "built_in"].includes(each.state));
    health.className = bad.length ? "health bad" : "health";
    health.title = `Planner ${models.planner.name}: ${HEALTH[models.planner.state]}\nPerception ${models.perception.name}: ${HEALTH[models.perception.state]}`;
    health.append(bad.length ? `${bad[0].name}: ${HEALTH[bad[0].state]}` : "ready");
  }

  get("/pairs").then((names) => { pair.replaceChildren(...names.map((name) => h("option", { value: name }, name.replace("+", " + ")))); showHealth(); })
    .catch((error) => notify(error.message));
  let described = "";
  on("state", (state) => {
    if (described !== state.name) { described = state.name; first.checked = !state.simulated; restore(); }
  });
  on("camera", () => { described = ""; ready = early = false; busy(null); clear(); });
  on("unavailable", () => {
    if (!described) thread.replaceChildren(h("p", { className: "empty" }, "The conversation opens here when the camera responds."));
  });
  on("status", (status) => { busy(status.run); if (status.run && described) attach(status.run); });
  return element;
}
