// The Benchmark tab: start an evaluation, and select one to view. The server runs the evaluations.

import { get, post } from "./api.js";
import { on, shared } from "./app_state.js";
import { STATES, percent, displayName } from "./benchmark_labels.js";
import { h, notify } from "./dom.js";
import { makeEvaluation } from "./evaluation.js";

const POLL_MS = 1000, SLOW_POLL_MS = 5000;

export function makeBenchmark() {
  const list = h("ul", { className: "run-list", "aria-label": "Evaluations" });
  const form = makeForm(start);
  const detail = makeEvaluation({ changed: refresh, removed: () => { chosen = ""; refresh(); } });
  const element = h("section", { className: "page runs benchmark", "aria-label": "Benchmark", hidden: true },
    h("div", { className: "finder" }, form.element, h("h2", {}, "Evaluations"), list), detail.element);
  let chosen = "", timer = 0, requests = 0;

  async function start(body) {
    const evaluation = await post("/benchmark/evaluations", body);
    chosen = evaluation.id;
    await refresh();
  }

  async function refresh() {
    clearTimeout(timer);
    if (element.hidden) return;
    const request = ++requests;
    let busy = false;
    try {
      const rows = await get("/benchmark/evaluations");
      if (request !== requests) return;
      if (!rows.some((each) => each.id === chosen)) chosen = rows[0]?.id ?? "";
      const running = rows.find((each) => each.state === "running") ?? null;
      busy = Boolean(running) || rows.some((each) => each.report === "making");
      form.setRunning(running);
      draw(rows);
      detail.show(rows.find((each) => each.id === chosen) ?? null);
    } catch (error) {
      if (request === requests) list.replaceChildren(h("li", { className: "problem" }, error.message));
    }
    if (request === requests) timer = setTimeout(refresh, busy ? POLL_MS : SLOW_POLL_MS);
  }

  function draw(rows) {
    const entries = rows.map(entry);
    // The list is redrawn every second. Keep entries that have not changed, so that they keep the focus.
    const before = new Map([...list.children].map((each) => [each.dataset.id, each]));
    const focus = list.contains(document.activeElement) ? document.activeElement.value : null;
    const now = entries.map((each) => (before.get(each.dataset.id)?.textContent === each.textContent ? before.get(each.dataset.id) : each));
    if (now.length !== list.children.length || now.some((each, index) => each !== list.children[index])) list.replaceChildren(...now);
    if (!rows.length) list.replaceChildren(h("li", { className: "empty" }, "No evaluations yet. Start one above; the lite split takes a few minutes."));
    for (const each of list.querySelectorAll("button")) each.setAttribute("aria-pressed", String(each.value === chosen));
    if (focus) list.querySelector(`button[value="${CSS.escape(focus)}"]`)?.focus();
  }

  function entry(row) {
    const when = new Date(row.started).toLocaleString([], { dateStyle: "short", timeStyle: "short" });
    const { progress } = row;
    const score = progress?.micro ? ` · ${percent(progress.micro.value)}` : "";
    const how = row.state === "running" && progress?.runs ? `${progress.done} of ${progress.runs}` : STATES[row.state];
    return h("li", { "data-id": row.id }, h("button", { type: "button", value: row.id, onclick: () => { chosen = row.id; refresh(); } },
      h("span", { className: "what" }, row.pair.replace("+", " + ")),
      h("span", { className: "when" }, `${row.split}${row.limit ? `, at most ${row.limit}` : ""}${row.categories.length ? `, ${row.categories.map(displayName).join(", ")}` : ""}`),
      h("span", { className: `when ${row.state}` }, `${when} · ${how}${score}`)));
  }

  on("show", (name) => {
    element.hidden = name !== "benchmark";
    if (!element.hidden) form.load();
    refresh();
  });
  return element;
}

function makeForm(onStart) {
  const pair = h("select", { id: "eval-pair" }), split = h("select", { id: "eval-split", onchange: () => draw() });
  const limit = h("input", { id: "eval-limit", type: "number", min: "1", max: "10000", placeholder: "all", inputMode: "numeric", oninput: () => draw() });
  const chips = h("div", { className: "chips", role: "group", "aria-label": "Categories" });
  const sum = h("p", { className: "muted sum" }), button = h("button", { className: "primary" }, "Start");
  const fields = h("div", { className: "fields" },
    h("label", { htmlFor: "eval-pair" }, "Pair"), pair, h("label", { htmlFor: "eval-split" }, "Tasks"), split, h("label", { htmlFor: "eval-limit" }, "Limit"), limit);
  const note = h("p", { className: "muted" });
  const element = h("form", { className: "start", "aria-label": "New evaluation", onsubmit: submit }, h("h1", {}, "Benchmark"), fields, chips, h("div", { className: "row" }, sum, h("span", { className: "space" }), button), note);
  const picked = new Set();
  let splits = [], blocked = "", running = null, sending = false;

  async function load() {
    if (splits.length) return;
    for (const each of [pair, split]) each.replaceChildren(h("option", {}, "Loading …"));
    draw();
    try {
      const found = await get("/benchmark");
      splits = found.splits;
      blocked = found.missing || (shared.me?.role === "viewer" ? "Your token does not permit starting evaluations. Sign in with an operator's token." : "");
      pair.replaceChildren(...found.pairs.map((name) => h("option", { value: name }, name.replace("+", " + "))));
      split.replaceChildren(...splits.map((each) => h("option", { value: each.name }, `${each.name} · ${each.tasks} tasks`)));
      split.value = splits.some((each) => each.name === "lite") ? "lite" : splits[0]?.name;
      draw();
    } catch (error) {
      note.textContent = error.message;
    }
  }

  function draw() {
    const chosen = splits.find((each) => each.name === split.value);
    const counts = chosen?.by_category ?? {};
    for (const name of [...picked]) if (!counts[name]) picked.delete(name);
    const focus = chips.contains(document.activeElement) ? document.activeElement.value : null;
    chips.replaceChildren(...Object.entries(counts).map(([name, count]) => h("button", { type: "button", className: "chip", value: name, "aria-pressed": String(picked.has(name)),
      title: `${count} tasks`, onclick: () => { if (!picked.delete(name)) picked.add(name); draw(); } }, displayName(name))));
    if (focus) chips.querySelector(`[value="${focus}"]`)?.focus();
    const all = picked.size ? [...picked].reduce((total, name) => total + counts[name], 0) : chosen?.tasks ?? 0;
    const tasks = Math.min(all, Number(limit.value) || all);
    sum.textContent = !splits.length ? "" : `${tasks} ${tasks === 1 ? "task" : "tasks"}${picked.size ? "" : ", all categories"}`;
    button.disabled = Boolean(blocked || running) || sending || !splits.length;
    note.textContent = blocked || (running ? "An evaluation is in progress. You can start the next one after it has ended." : "");
    note.hidden = !note.textContent;
  }

  async function submit(event) {
    event.preventDefault();
    sending = true;
    draw();
    try {
      await onStart({ pair: pair.value, split: split.value, limit: limit.value ? Number(limit.value) : null, categories: [...picked] });
    } catch (error) {
      notify(error.message);
    } finally {
      sending = false;
      draw();
    }
  }

  return { element, load, setRunning(now) { if (Boolean(now) !== Boolean(running)) { running = now; draw(); } } };
}
