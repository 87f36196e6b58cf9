// The durations of instructions by component, with the real-time criterion of the SCOPE paper: 500 ms per step, or 2 Hz.

import { get, part } from "./api.js";
import { emit, on, shared } from "./app_state.js";
import { h, seconds, svg } from "./dom.js";
import { OUTCOMES } from "./turn.js";

export const PARTS = [["planner_s", "Planner"], ["perception_s", "Perception"], ["camera_s", "Camera"], ["render_s", "Rendering"], ["tools_s", "Tools"]];
const REAL_TIME_S = 0.5;
const ROW = 30, LEFT = 230, WIDTH = 900, RIGHT = 70;

export const tools = (row) => Math.max(0, row.total_s - row.planner_s - row.perception_s - row.camera_s - row.render_s);

export function makeTimings() {
  const chart = h("div", { className: "chart" }), table = h("dl", { className: "sums" });
  const element = h("section", { className: "page", "aria-label": "Timings", hidden: true },
    h("h1", {}, "Timings"), h("p", { className: "lead" }, "Seconds per step of each instruction, the newest first. The line marks 0.5 s (2 Hz), the paper's threshold for real-time control."),
    legend(), table, chart);

  async function refresh() {
    if (element.hidden || !shared.camera) return;
    let page;
    try {
      page = await get(`/runs?camera=${part(shared.camera)}&kind=instruction&limit=25`);
    } catch (error) {
      chart.replaceChildren(h("p", { className: "problem" }, error.message));
      return;
    }
    const rows = page.runs.filter((run) => run.steps > 0 && run.total_s > 0);
    table.replaceChildren(...(rows.length ? sums(rows) : []));
    chart.replaceChildren(rows.length ? bars(rows) : h("p", { className: "empty" }, "No instructions yet. Their durations appear here."));
  }

  on("show", (name) => { element.hidden = name !== "timings"; refresh(); });
  on("run ended", () => setTimeout(refresh, 300));
  on("camera", refresh);
  return element;
}

export function legend() {
  return h("ul", { className: "legend" }, PARTS.map(([key, name]) => h("li", {}, h("i", { className: key }), name)));
}

function sums(rows) {
  const all = rows.reduce((sum, row) => sum + row.total_s, 0);
  return PARTS.map(([key, name]) => {
    const sum = rows.reduce((total, row) => total + (key === "tools_s" ? tools(row) : row[key]), 0);
    return h("div", {}, h("dt", {}, name), h("dd", {}, `${Math.round((100 * sum) / all)}%`, h("small", {}, seconds(sum))));
  });
}

function bars(rows) {
  const perStep = rows.map((row) => row.total_s / row.steps), most = Math.max(0.75, ...perStep);
  const x = (value) => (value / most) * (WIDTH - LEFT - RIGHT);
  const height = rows.length * ROW + 24;
  const graph = svg("svg", { viewBox: `0 0 ${WIDTH} ${height}`, role: "group", "aria-label": "Seconds per step of each instruction" });
  rows.forEach((row, index) => {
    const y = 20 + index * ROW;
    const label = svg("text", { x: LEFT - 12, y: y + 15, "text-anchor": "end", class: "label" });
    label.textContent = row.instruction.length > 34 ? `${row.instruction.slice(0, 33)}…` : row.instruction;
    const group = svg("g", { class: "bar-row", tabindex: "0", role: "button" }, label);
    group.setAttribute("aria-label", `${row.instruction}: ${seconds(perStep[index])} per step`);
    let from = LEFT;
    for (const [key, name] of PARTS) {
      const value = (key === "tools_s" ? tools(row) : row[key]) / row.steps;
      const rect = svg("rect", { x: from, y: y + 3, width: Math.max(0, x(value)), height: ROW - 14, class: key });
      const title = svg("title");
      title.textContent = `${name} ${seconds(value)} per step · ${OUTCOMES[row.outcome] ?? row.outcome}`;
      rect.append(title);
      group.append(rect);
      from += x(value);
    }
    const total = svg("text", { x: from + 8, y: y + 15, class: "value" });
    total.textContent = seconds(perStep[index]);
    group.append(total);
    const open = () => emit("open run", row.id);
    group.addEventListener("click", open);
    group.addEventListener("keydown", (event) => { if (event.key === "Enter") open(); });
    graph.append(group);
  });
  const at = LEFT + x(REAL_TIME_S);
  const mark = svg("text", { x: at + 4, y: 11, class: "limit-label" });
  mark.textContent = "2 Hz";
  graph.append(svg("line", { x1: at, x2: at, y1: 2, y2: height, class: "limit" }), mark);
  return graph;
}
