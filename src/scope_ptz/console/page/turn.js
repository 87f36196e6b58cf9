// One instruction in the language panel: its steps as they happen, its answer, and buttons for feedback, frames and undo.

import { command, follow, get, part, url } from "./api.js";
import { emit, shared } from "./app_state.js";
import { feedbackButtons } from "./feedback.js";
import { h, notify, seconds } from "./dom.js";
import { marksOf } from "./marks.js";

export const OUTCOMES = {
  answered: "Done", clarification: "Question", refused: "Refused", step_limit: "Step limit reached", budget: "Budget exhausted",
  planner_error: "The planner failed", camera_error: "The camera failed", cancelled: "Cancelled", unfinished: "Interrupted",
};
const TIMES = [["planner_s", "Planner"], ["perception_s", "Perception"], ["camera_s", "Camera"], ["render_s", "Rendering"], ["tools_s", "Tools"]];

// `live` is true for a run in progress on the real camera, whose marks are drawn on the live view.
export function makeTurn(run, { live = false, onEnd = null, kind = "instruction", onConfirm = null } = {}) {
  const steps = h("ol", { className: "steps" });
  const thinking = h("p", { className: "thinking", role: "status" }, "Thinking …");
  const answer = h("div", { className: "answer" });
  const foot = h("div", { className: "row foot" });
  const element = h("article", { className: `turn ${kind}` }, h("p", { className: "request" }, run.instruction), steps, thinking, answer, foot);
  let position = 0;
  if (!run.id) return { element, fail };

  const source = follow(run.id, {
    call(call) {
      steps.append(step(run.id, call, position));
      position += 1;
      const marks = live ? marksOf(call) : null;
      if (marks) emit("marks", marks);
      thinking.textContent = "Thinking …";
      element.dispatchEvent(new Event("grown"));
    },
    decision(record) {
      const names = (record.decision.calls ?? []).map((each) => each.name.replaceAll("_", " "));
      if (names.length) thinking.textContent = `${names.join(", ")} …`;
    },
    end(record) {
      thinking.remove();
      finish(record);
      element.dispatchEvent(new Event("grown"));
      onEnd?.(record);
    },
    lost() { thinking.remove(); fail("This instruction was interrupted because the server stopped. Send it again."); onEnd?.(null); },
  });

  function fail(message) {
    thinking.remove();
    answer.replaceChildren(h("p", { className: "problem" }, message));
  }

  async function finish(record) {
    const good = ["answered", "clarification"].includes(record.outcome);
    const { text, note } = splitNote(record.text);
    const outcome = OUTCOMES[record.outcome] ?? record.outcome;
    if (!good) answer.append(h("span", { className: "outcome" }, outcome));
    // Do not repeat text that a step or the outcome already shows.
    const repeated = !text || record.outcome === "cancelled" || text === outcome || text === steps.lastElementChild?.querySelector(".result").textContent;
    if (good || !repeated) answer.append(h("p", { className: good ? "" : "problem" }, text || outcome));
    if (note) answer.append(h("p", { className: "note" }, note));
    if (kind === "dry_run") { await confirmation(); return; }
    foot.append(h("span", { className: "times", title: timesText(record.timings) }, seconds(record.timings.total_s)), ...feedbackButtons(run.id),
      h("button", { type: "button", className: "link", onclick: () => emit("open run", run.id) }, "Frames"));
    if (live) foot.append(h("button", { type: "button", className: "link", onclick: () => command(shared.camera, "/undo") }, "Undo"));
  }

  async function confirmation() {
    const state = await get(`/runs/${part(run.id)}`).catch((error) => { notify(error.message); return null; });
    const moves = state?.preview ?? [];
    answer.append(h("div", { className: "preview" }, h("h3", {}, moves.length ? "The camera would:" : "The camera would not move."),
      h("ul", {}, moves.map((each) => h("li", {}, each)))));
    if (!onConfirm) return;
    const go = h("button", { type: "button", className: "primary", onclick: () => { foot.replaceChildren(); onConfirm(run.instruction); } }, "Carry it out");
    foot.append(go, h("button", { type: "button", onclick: () => element.remove() }, "Discard"));
  }

  return { element, fail, close: () => source.close() };
}

function step(run, call, position) {
  const { call: toolCall, result, error } = call.outcome;
  const name = result?.frames?.at(-1) ?? call.frame;
  const image = name && h("img", { alt: `Picture of step ${position + 1}`, loading: "lazy", src: url(`/runs/${part(run)}/pictures/${name}?marks=true`) });
  const shown = Object.entries(toolCall.arguments ?? {}).map(([key, value]) => `${key} ${typeof value === "object" ? JSON.stringify(value) : value}`).join(", ");
  return h("li", { className: error ? "step failed" : "step" },
    h("div", {},
      h("p", { className: "tool" }, h("b", {}, toolCall.name.replaceAll("_", " ")), " ", h("span", { className: "arguments" }, shown)),
      h("p", { className: "result" }, error ?? result?.message ?? ""),
      h("p", { className: "row small" }, h("span", {}, seconds(call.timings.total_s)), ...feedbackButtons(run, position))),
    image && h("button", { type: "button", className: "shot", title: "Open the frames of this run", onclick: () => emit("open run", run) }, image));
}

// Split a source note off an answer. It is shown below the answer.
function splitNote(text) {
  const match = /^(.*?)\s*\((Source: [^()]*)\)$/s.exec(text);
  return match ? { text: match[1], note: match[2] } : { text, note: "" };
}

export function timesText(timings) {
  const tools = Math.max(0, timings.total_s - timings.planner_s - timings.perception_s - timings.camera_s - timings.render_s);
  return TIMES.map(([key, name]) => `${name} ${seconds(key === "tools_s" ? tools : timings[key])}`).join("\n");
}
