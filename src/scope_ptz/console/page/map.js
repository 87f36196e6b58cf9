// A small map of the sphere around the camera: its field of view, its limits and keep-out regions, visited presets and detections.

import { command } from "./api.js";
import { on, shared } from "./app_state.js";
import { h } from "./dom.js";
import { directionOf, panTiltOf } from "./geometry.js";

const W = 360, H = 120, TOP_TILT = 60, BOTTOM_TILT = -60, SCALE = 2;

export function makeMap() {
  const canvas = h("canvas", { width: W * SCALE, height: H * SCALE, role: "img", title: "Click to turn the camera there" });
  canvas.setAttribute("aria-label", "Map of the directions around the camera");
  const element = h("section", { className: "map", "aria-label": "Map" }, h("h2", {}, "Around the camera"), canvas);
  let found = null, drawnPose = "";

  const x = (pan) => ((pan + 180) / 360) * W;
  const y = (tilt) => ((TOP_TILT - tilt) / (TOP_TILT - BOTTOM_TILT)) * H;

  function draw(force) {
    const { live, state } = shared;
    if (!live || !state) return;
    const pose = JSON.stringify(live.pose);
    if (!force && pose === drawnPose) return;
    drawnPose = pose;
    const style = getComputedStyle(element), color = (name) => style.getPropertyValue(name).trim();
    const c = canvas.getContext("2d");
    c.setTransform(SCALE, 0, 0, SCALE, 0, 0);
    c.clearRect(0, 0, W, H);
    const limits = state.limits;
    c.fillStyle = color("--sunk");
    c.fillRect(x(limits.min_pan_deg), y(limits.max_tilt_deg), x(limits.max_pan_deg) - x(limits.min_pan_deg), y(limits.min_tilt_deg) - y(limits.max_tilt_deg));
    c.strokeStyle = color("--edge");
    c.lineWidth = 0.5;
    for (let pan = -150; pan <= 150; pan += 30) line(c, x(pan), 0, x(pan), H);
    for (let tilt = -30; tilt <= 30; tilt += 30) line(c, 0, y(tilt), W, y(tilt));
    c.fillStyle = color("--keepout");
    for (const region of state.keep_out) {
      c.fillRect(x(region.pan_deg[0]), y(region.tilt_deg[1]), x(region.pan_deg[1]) - x(region.pan_deg[0]), y(region.tilt_deg[0]) - y(region.tilt_deg[1]));
    }
    c.fillStyle = color("--soft");
    drawPresets(c, live, state);
    c.strokeStyle = c.fillStyle = color("--accent");
    c.lineWidth = 1.5;
    outline(c, live);
    if (found && found.viewpoint === (live.viewpoint ?? null)) for (const place of found.places) dot(c, x(place.middle.pan_deg), y(place.middle.tilt_deg), 2.5);
    c.fillStyle = color("--soft");
    c.font = "9px system-ui, sans-serif";
    for (const pan of [-90, 0, 90]) c.fillText(`${pan}°`, x(pan) + 3, H - 4);
  }

  // Presets of the current viewpoint with a known pose. Names that would cover another one are omitted.
  function drawPresets(c, live, state) {
    const taken = [];
    c.font = "9px system-ui, sans-serif";
    for (const { name, pose, viewpoint } of state.presets) {
      if (!pose || (viewpoint ?? null) !== (live.viewpoint ?? null)) continue;
      const at = { x: x(pose.pan_deg), y: y(pose.tilt_deg) };
      dot(c, at.x, at.y, 2.5);
      const width = c.measureText(name).width, left = at.x + 5 + width > W ? at.x - 5 - width : at.x + 5;
      if (taken.some((each) => Math.abs(each.y - at.y) < 10 && left < each.right && left + width > each.left)) continue;
      taken.push({ y: at.y, left, right: left + width });
      c.fillText(name, left, at.y + 3);
    }
  }

  function outline(c, live) {
    const points = [], steps = 8, aspect = live.width / live.height;
    for (let i = 0; i < steps; i++) points.push([i / steps, 0]);
    for (let i = 0; i < steps; i++) points.push([1, i / steps]);
    for (let i = 0; i < steps; i++) points.push([1 - i / steps, 1]);
    for (let i = 0; i <= steps; i++) points.push([0, 1 - i / steps]);
    c.beginPath();
    let last = null;
    for (const [u, v] of points) {
      const at = panTiltOf(directionOf(u, v, live.pose, live.hfov_deg, aspect));
      const jumped = last !== null && Math.abs(at.pan_deg - last) > 180;
      c[last === null || jumped ? "moveTo" : "lineTo"](x(at.pan_deg), y(at.tilt_deg));
      last = at.pan_deg;
    }
    c.stroke();
    const middle = panTiltOf(directionOf(0.5, 0.5, live.pose, live.hfov_deg, aspect));
    dot(c, x(middle.pan_deg), y(middle.tilt_deg), 2);
  }

  canvas.addEventListener("click", (event) => {
    const box = canvas.getBoundingClientRect();
    const pan_deg = ((event.clientX - box.left) / box.width) * 360 - 180;
    const tilt_deg = TOP_TILT - ((event.clientY - box.top) / box.height) * (TOP_TILT - BOTTOM_TILT);
    command(shared.camera, "/move", { pan_deg, tilt_deg });
  });
  on("frame", () => draw(false));
  on("state", () => draw(true));
  on("theme", () => draw(true));
  on("marks", (marks) => { found = marks; draw(true); });
  on("camera", () => { found = null; drawnPose = ""; canvas.getContext("2d").clearRect(0, 0, W * SCALE, H * SCALE); });
  return element;
}

function line(c, x0, y0, x1, y1) {
  c.beginPath();
  c.moveTo(x0, y0);
  c.lineTo(x1, y1);
  c.stroke();
}

function dot(c, x, y, radius) {
  c.beginPath();
  c.arc(x, y, radius, 0, 2 * Math.PI);
  c.fill();
}
