// The view of one evaluation: its progress, its scores so far, its failures, and its report.

import { part, post, request, url } from "./api.js";
import { shared } from "./app_state.js";
import { STATES, percent, displayName } from "./benchmark_labels.js";
import { askFor, h, notify, svg } from "./dom.js";
import { makeFailures } from "./failures.js";

// `changed` is called after each command, and `removed` after the evaluation has been removed.
export function makeEvaluation({ changed, removed }) {
  const title = h("h1", {}), lead = h("p", { className: "lead" }), state = h("span", { className: "state", role: "status" });
  const actions = h("div", { className: "row actions" }), bar = h("div", { className: "progress", role: "progressbar", "aria-label": "Finished tasks" });
  const counts = h("p", { className: "muted counts" }), problem = h("p", { className: "problem", hidden: true });
  const scores = h("dl", { className: "scores" }), categories = h("div", { className: "categories" }), now = h("p", { className: "muted now" });
  const failures = makeFailures();
  const body = h("div", { className: "evaluation" }, h("div", { className: "row top" }, title, state, h("span", { className: "space" }), actions), lead, problem, bar, counts, now,
    h("div", { className: "results" }, scores, categories), failures.element);
  const empty = h("div", { className: "empty intro" }, h("h1", {}, "Evaluate a pair of models"),
    h("p", {}, "An evaluation runs a planner and a perception backend on tasks with known answers. Its score, its failures with their pictures, and its report appear here."),
    h("p", {}, "It runs in a separate process on the server, so you can close this page and come back later."));
  const element = h("div", { className: "detail" }, empty);
  let drawnActions = "", shown = "";

  function show(row) {
    if (!row) {
      if (!element.contains(empty)) element.replaceChildren(empty);
      failures.show(null);
      return;
    }
    if (!element.contains(body)) element.replaceChildren(body);
    if (shown !== row.id) { shown = row.id; element.scrollTop = 0; }
    const { progress } = row;
    set(title, row.pair.replace("+", " + "));
    set(state, STATES[row.state]);
    state.className = `state ${row.state}`;
    set(lead, describe(row));
    const text = row.message || row.report_message || (row.state === "interrupted" ? "The evaluation was interrupted. Finished tasks are kept. Resume it to run the other tasks." : "");
    set(problem, text);
    problem.hidden = !text;
    drawBar(progress, row.state);
    set(counts, countsText(row));
    const running = progress?.running ?? [];
    set(now, row.state === "running" && running.length ? `Running: ${running.map((each) => `“${each.instruction}”`).slice(0, 2).join(", ")}${running.length > 2 ? ` and ${running.length - 2} more` : ""}` : "");
    now.hidden = !now.textContent;
    scores.hidden = categories.hidden = !progress?.micro;
    if (progress?.micro) drawScores(progress);
    drawActions(row);
    failures.show(row);
  }

  function describe(row) {
    const when = new Date(row.started).toLocaleString([], { dateStyle: "medium", timeStyle: "short" });
    const parts = [`Split ${row.split}`, row.limit && `at most ${row.limit} tasks`, row.categories.length && row.categories.map(displayName).join(", "), `started ${when}${row.actor ? ` by ${row.actor}` : ""}`,
      row.resumed && `resumed ${row.resumed === 1 ? "once" : `${row.resumed} times`}`];
    return parts.filter(Boolean).join(" · ");
  }

  function countsText(row) {
    const { progress } = row;
    if (!progress?.runs) return row.state === "running" ? "Loading scenes and models …" : "No task has finished.";
    const left = row.state === "running" && progress.seconds_left !== null && progress.done < progress.runs ? `about ${duration(progress.seconds_left)} left` : "";
    return [`${progress.done} of ${progress.runs} tasks`, `${progress.correct} correct`, `${progress.incorrect} wrong`, progress.unscored && `${progress.unscored} unscored`,
      progress.broken && `${progress.broken} with an infrastructure failure`, left].filter(Boolean).join(" · ");
  }

  function drawBar(progress, how) {
    const total = progress?.runs || 1;
    bar.classList.toggle("waiting", how === "running" && !progress?.runs);
    bar.setAttribute("aria-valuemin", 0);
    bar.setAttribute("aria-valuemax", total);
    bar.setAttribute("aria-valuenow", progress?.done ?? 0);
    const parts = [["correct", progress?.correct], ["wrong", (progress?.incorrect ?? 0) + (progress?.unscored ?? 0)], ["broken", progress?.broken]];
    if (!bar.childNodes.length) bar.append(...parts.map(([name]) => h("i", { className: name })));
    parts.forEach(([, value], index) => { bar.children[index].style.width = `${(100 * (value ?? 0)) / total}%`; });
  }

  function drawScores(progress) {
    const rows = [["Correct tasks", progress.micro], ["Mean over categories", progress.macro]];
    scores.replaceChildren(...rows.filter(([, score]) => score).map(([name, score]) => h("div", {}, h("dt", {}, name),
      h("dd", {}, percent(score.value), h("small", {}, score.low === null ? "interval unknown" : `95%: ${(100 * score.low).toFixed(0)} to ${(100 * score.high).toFixed(0)}`)), h("dd", {}, scale(score)))));
    categories.replaceChildren(h("table", {}, h("caption", {}, "By category"), h("tbody", {}, progress.categories.map((each) => {
      const fill = h("i", {});
      fill.style.width = `${100 * (each.accuracy ?? 0)}%`;
      return h("tr", {}, h("th", { scope: "row" }, displayName(each.category)), h("td", { className: "share" }, h("span", { className: "track" }, fill)),
        h("td", {}, each.accuracy === null ? "–" : `${(100 * each.accuracy).toFixed(0)}%`), h("td", { className: "muted" }, `${each.correct} of ${each.runs}`));
    }))), h("p", { className: "muted" }, "These verdicts were computed from the traces as the tasks ended. The report computes them again from the log."));
  }

  function drawActions(row) {
    const operator = shared.me?.role !== "viewer";
    const key = [row.id, row.state, row.can_resume, row.report, operator, Boolean(row.progress?.done)].join();
    if (key === drawnActions) return;
    drawnActions = key;
    const address = `/benchmark/evaluations/${part(row.id)}`;
    const act = (path) => post(address + path).then(changed).catch((error) => notify(error.message));
    const remove = async () => {
      if (await askFor({ title: "Remove this evaluation?", label: "Its logs and its report are deleted.", confirm: "Remove" }) === null) return;
      request("DELETE", address).then(removed).catch((error) => notify(error.message));
    };
    const report = row.report === "ready" ? h("a", { className: "button primary", href: url(`${address}/report/index.html`), target: "_blank", rel: "noopener" }, "Open report")
      : row.report === "making" ? h("button", { type: "button", disabled: true }, "Writing report …")
        : row.progress?.done && row.state !== "running" && operator ? h("button", { type: "button", className: row.state === "finished" ? "primary" : "", onclick: () => act("/report") }, "Make report") : null;
    actions.replaceChildren(...[operator && row.state === "running" && h("button", { type: "button", className: "danger", onclick: () => act("/cancel") }, "Cancel"),
      operator && row.can_resume && h("button", { type: "button", onclick: () => act("/resume") }, row.state === "finished" ? "Retry broken tasks" : "Resume"), report,
      operator && row.state !== "running" && h("button", { type: "button", onclick: remove }, "Remove")].filter(Boolean));
  }

  return { element, show };
}

// A score on a scale from 0 to 100%, with its interval.
function scale(score) {
  const x = (value) => 6 + value * 188;
  const low = score.low ?? score.value, high = score.high ?? score.value;
  return svg("svg", { viewBox: "0 0 200 14", class: "interval", "aria-hidden": "true" }, svg("line", { x1: 6, x2: 194, y1: 7, y2: 7, class: "axis" }),
    svg("rect", { x: x(low), y: 4, width: Math.max(0, x(high) - x(low)), height: 6, rx: 3, class: "range" }), svg("circle", { cx: x(score.value), cy: 7, r: 5, class: "point" }));
}

function duration(value) {
  if (value < 90) return `${Math.max(1, Math.round(value))} s`;
  if (value < 5400) return `${Math.round(value / 60)} min`;
  return `${(value / 3600).toFixed(1)} h`;
}

function set(element, text) {
  if (element.textContent !== text) element.textContent = text;
}
