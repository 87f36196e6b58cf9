// The failures of an evaluation: expected and actual answers, error modes, and the steps and pictures of each run.

import { get, part, url } from "./api.js";
import { MODES, VERDICTS, displayName } from "./benchmark_labels.js";
import { h, iconButton, seconds } from "./dom.js";

const PAGE = 60;

export function makeFailures() {
  const title = h("h2", {}), mode = h("select", { "aria-label": "Error mode", onchange: () => load() });
  const list = h("ul", { className: "failures" }), more = h("button", { type: "button", className: "link", hidden: true, onclick: () => load(true) }, "More");
  const element = h("section", { className: "failed", "aria-label": "Failures" }, h("div", { className: "row" }, title, h("span", { className: "space" }), mode), list, more);
  let evaluation = "", known = "", rows = [], requests = 0;

  function show(row) {
    const failed = (row?.progress?.done ?? 0) - (row?.progress?.correct ?? 0);
    element.hidden = !row?.progress?.done;
    const key = row ? `${row.id} ${failed} ${row.state}` : "";
    if (key === known) return;
    if (row?.id !== evaluation) { mode.value = ""; rows = []; list.replaceChildren(); }
    evaluation = row?.id ?? "";
    known = key;
    if (row) load();
  }

  async function load(next = false) {
    const request = ++requests, address = `/benchmark/evaluations/${part(evaluation)}`;
    try {
      // A reload during the evaluation keeps the number of rows.
      const offset = next ? rows.length : 0, limit = next ? PAGE : Math.min(500, Math.max(PAGE, rows.length));
      const page = await get(`${address}/trials?verdict=failed&limit=${limit}&offset=${offset}${mode.value ? `&error_mode=${mode.value}` : ""}`);
      if (request !== requests) return;
      rows = next ? [...rows, ...page.trials] : page.trials;
      draw(page);
    } catch (error) {
      if (request === requests) list.replaceChildren(h("li", { className: "problem" }, error.message));
    }
  }

  function draw(page) {
    title.textContent = page.count ? `Failures: ${page.count}` : "Failures";
    const selected = mode.value, all = Object.entries(page.error_modes);
    mode.replaceChildren(h("option", { value: "" }, "All error modes"), ...all.map(([name, count]) => h("option", { value: name }, `${MODES[name] ?? displayName(name)} (${count})`)));
    mode.value = selected;
    mode.hidden = !all.length;
    more.hidden = rows.length >= page.count;
    const focus = list.contains(document.activeElement) ? document.activeElement.value : null;
    list.replaceChildren(...rows.map((each, index) => h("li", {}, h("button", { type: "button", value: each.sample, onclick: () => viewer(evaluation, rows, index) },
      h("span", { className: "what" }, each.instruction),
      h("span", { className: "pair" }, h("b", {}, "Expected"), h("span", {}, each.expected || "–")),
      h("span", { className: "pair" }, h("b", {}, "Answered"), h("span", {}, each.answer || "nothing")),
      h("span", { className: "tags" }, h("span", { className: "tag" }, each.error_mode ? MODES[each.error_mode] ?? displayName(each.error_mode) : VERDICTS[each.headline]), h("span", {}, `${displayName(each.category)} · ${each.scene}`))))));
    if (!rows.length) list.replaceChildren(h("li", { className: "empty" }, "All finished tasks were answered correctly."));
    if (focus) list.querySelector(`button[value="${CSS.escape(focus)}"]`)?.focus();
  }

  return { element, show };
}

// A dialog for one failed run: a picture on the left, and the answers, checks and steps on the right.
function viewer(evaluation, rows, first) {
  const marked = h("input", { type: "checkbox", id: "failure-marks", checked: true, onchange: () => draw() });
  const count = h("span", { className: "muted" }), heading = h("h2", {}), picture = h("div", { className: "large" }), facts = h("div", { className: "facts", tabIndex: 0, role: "region", "aria-label": "Details" });
  const dialog = h("dialog", { className: "viewer failure", "aria-label": "Failed task", onclose: () => dialog.remove() },
    h("div", { className: "row" }, count, h("span", { className: "space" }), h("label", { className: "check", htmlFor: "failure-marks" }, marked, "Marks"),
      iconButton("left", "Previous failure (←)", () => open(index - 1)), iconButton("right", "Next failure (→)", () => open(index + 1)), iconButton("close", "Close", () => dialog.close())),
    heading, h("div", { className: "sides" }, picture, facts));
  let index = first, chosen = null, details = null;
  dialog.addEventListener("keydown", (event) => {
    if (event.key === "ArrowLeft") open(index - 1);
    if (event.key === "ArrowRight") open(index + 1);
  });

  async function open(to) {
    index = (to + rows.length) % rows.length;
    const row = rows[index];
    count.textContent = `${index + 1} of ${rows.length} · ${displayName(row.category)} · ${row.difficulty} · ${row.scene}, preset ${row.preset}`;
    heading.textContent = row.instruction;
    details = null;
    picture.replaceChildren();
    facts.replaceChildren(h("p", { className: "muted" }, "Loading …"));
    try {
      const found = await get(`/benchmark/evaluations/${part(evaluation)}/trials/${part(row.sample)}`);
      if (rows[index] !== row) return;
      details = found;
      const taken = details.steps.flatMap((each) => each.pictures);
      chosen = (taken.findLast((each) => each.marks) ?? taken.at(-1))?.name ?? details.start_picture;
      draw();
    } catch (error) {
      if (rows[index] === row) facts.replaceChildren(h("p", { className: "problem" }, error.message));
    }
  }

  const source = (name) => url(`/benchmark/evaluations/${part(evaluation)}/trials/${part(rows[index].sample)}/pictures/${name}${marked.checked ? "?marks=true" : ""}`);

  function draw() {
    if (!details) return;
    const { trial, demands, checks, steps, missing, start_picture: start } = details;
    picture.replaceChildren(chosen ? h("img", { alt: caption(chosen), src: source(chosen) }) : h("p", { className: "empty" }, missing || "This run took no pictures."), chosen ? h("p", { className: "muted" }, caption(chosen)) : "");
    const pick = (name) => h("button", { type: "button", className: "shot", "aria-pressed": String(name === chosen), "aria-label": `Show: ${caption(name)}`, onclick: () => { chosen = name; draw(); } },
      h("img", { alt: "", loading: "lazy", src: source(name) }));
    const focus = facts.contains(document.activeElement) ? document.activeElement.getAttribute("aria-label") : null;
    const scroll = facts.scrollTop;
    facts.replaceChildren(
      h("dl", { className: "answers" }, ...pairs([["Expected", trial.expected || "–"], ["Answered", trial.answer || "nothing"],
        ["Verdict", `${VERDICTS[trial.headline]}${trial.error_mode ? ` (${MODES[trial.error_mode] ?? displayName(trial.error_mode)})` : ""}: ${trial.reason}`], demands.length && ["Required", demands.join(" ")]])),
      h("ul", { className: "checks", "aria-label": "Checks" }, checks.map((each) => h("li", { className: each.passed === false ? "bad" : "", title: each.reason }, `${each.name} ${each.passed === null ? "undecided" : each.passed ? "passed" : "failed"}`))),
      missing ? "" : h("ol", { className: "steps" },
        start && h("li", { className: "step" }, h("div", {}, h("p", { className: "tool" }, h("b", {}, "start"), " ", h("span", { className: "arguments" }, `preset ${trial.preset}`))), pick(start)),
        ...steps.map((each) => h("li", { className: each.failed ? "step failed" : "step" }, h("div", {},
          h("p", { className: "tool" }, h("b", {}, displayName(each.tool)), " ", h("span", { className: "arguments" }, Object.entries(each.arguments).map(([key, value]) => `${key} ${typeof value === "object" ? JSON.stringify(value) : value}`).join(", "))),
          h("p", { className: "result" }, each.message), h("p", { className: "small" }, seconds(each.seconds))), h("div", { className: "shots" }, each.pictures.map((one) => pick(one.name)))))));
    facts.scrollTop = scroll;
    if (focus) [...facts.querySelectorAll("button")].find((each) => each.getAttribute("aria-label") === focus)?.focus();
  }

  function caption(name) {
    const step = details.steps.findIndex((each) => each.pictures.some((one) => one.name === name));
    if (step < 0) return "The view at the start";
    const found = details.steps[step].pictures.find((one) => one.name === name);
    const label = `Step ${step + 1}, ${displayName(details.steps[step].tool)}`;
    return found.marks ? `${label}: ${found.marks} marked` : name.includes("full") ? `${label}: panorama` : label;
  }

  document.querySelector("#scope").append(dialog);
  dialog.showModal();
  open(first);
}

const pairs = (rows) => rows.filter(Boolean).map(([name, text]) => h("div", {}, h("dt", {}, name), h("dd", {}, text)));
