// Marks for the latest detections. They are drawn at their directions, so they stay on the objects when the camera turns.

import { shared } from "./app_state.js";
import { svg } from "./dom.js";
import { directionOf, fieldOfView, panTiltOf, pointOf } from "./geometry.js";

const MAX_NUMBERS = 40; // with more marks, the numbers would cover the picture

// The marks of a finished tool call; null if its result has no boxes.
export function marksOf(call) {
  const result = call.outcome.result;
  const boxes = result?.boxes ?? (result?.box ? [result.box] : []);
  if (!boxes.length || !result.pose || !shared.state) return null;
  const hfov = fieldOfView(shared.state.fields_of_view, result.pose.zoom);
  const aspect = shared.state.frame_width / shared.state.frame_height;
  return {
    label: result.description ?? result.target ?? "",
    places: boxes.map((box) => ({
      corners: [[box.x_min, box.y_min], [box.x_max, box.y_min], [box.x_max, box.y_max], [box.x_min, box.y_max]]
        .map(([x, y]) => directionOf(x, y, result.pose, hfov, aspect)),
      middle: panTiltOf(directionOf((box.x_min + box.x_max) / 2, (box.y_min + box.y_max) / 2, result.pose, hfov, aspect)),
    })),
    viewpoint: shared.live?.viewpoint ?? null,
  };
}

export function drawMarks(overlay, marks, facts) {
  if (!marks || !facts || marks.viewpoint !== (facts.viewpoint ?? null)) {
    if (overlay.childNodes.length) overlay.replaceChildren();
    return;
  }
  const { width, height } = facts, unit = width / 1280;
  overlay.setAttribute("viewBox", `0 0 ${width} ${height}`);
  const drawn = [];
  marks.places.forEach((place, index) => {
    const points = place.corners.map((each) => pointOf(each, facts.pose, facts.hfov_deg, width / height));
    if (points.some((each) => each === null)) return;
    drawn.push(svg("polygon", { points: points.map((p) => `${p.x * width},${p.y * height}`).join(" "), "stroke-width": 2 * unit }));
    if (marks.places.length > MAX_NUMBERS) return;
    const number = String(index + 1), x = points[0].x * width, y = Math.max(20 * unit, points[0].y * height);
    drawn.push(svg("rect", { x, y: y - 20 * unit, width: (9 * number.length + 9) * unit, height: 20 * unit }));
    const text = svg("text", { x: x + 4.5 * unit, y: y - 5.500 * unit, "font-size": 15 * unit });
    text.textContent = number;
    drawn.push(text);
  });
  overlay.replaceChildren(...drawn);
}
