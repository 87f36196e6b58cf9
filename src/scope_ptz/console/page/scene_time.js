// Scene time for a simulated camera: play and pause, seek, and change the speed. Changes apply to all of the camera's clients.

import { command } from "./api.js";
import { on, shared } from "./app_state.js";
import { h, icon, iconButton } from "./dom.js";

const SPEEDS = [0.25, 0.5, 1, 2, 4, 10];
const STEP_S = 10;
const MIN_RANGE_S = 120, ROUND_S = 60; // the slider ends at the next full minute, but not before MIN_RANGE_S
const LATEST_S = 86_400;

export const clockText = (time_s) => `${Math.floor(time_s / 60)}:${(time_s % 60).toFixed(1).padStart(4, "0")}`;

// Controls for a camera. `update` shows what the server reports: {time_s, playing, speed}.
export function makeSceneTime(camera) {
  const toggle = iconButton("pause", "Pause scene time", () => change({ playing: !now.playing }), { className: "quiet play" });
  const clock = h("output", { className: "clock" });
  const slider = h("input", { type: "range", min: 0, max: MIN_RANGE_S, step: 0.1, "aria-label": "Scene time in seconds" });
  const speed = h("select", { "aria-label": "Speed of scene time", title: "Speed of scene time", onchange: () => change({ speed: Number(speed.value) }) });
  const element = h("div", { className: "scene-time", role: "group", "aria-label": "Scene time" }, toggle,
    iconButton("back", `Back ${STEP_S} seconds`, () => step(-STEP_S)), slider, iconButton("ahead", `Forward ${STEP_S} seconds`, () => step(STEP_S)), clock, speed);
  let now = { time_s: 0, playing: true, speed: 1 }, at = performance.now(), dragged = false, pendingTime = null, sending = false;

  const present = () => now.time_s + (now.playing ? ((performance.now() - at) / 1000) * now.speed : 0);

  function update(reported) {
    if (sending || dragged) return; // do not override the user's input
    now = { ...reported };
    at = performance.now();
    draw();
  }

  function draw() {
    const held = dragged || pendingTime !== null; // the user's newest position has not been sent yet
    const time_s = held ? Number(slider.value) : present();
    if (toggle.dataset.playing !== String(now.playing)) {
      toggle.dataset.playing = now.playing;
      toggle.replaceChildren(icon(now.playing ? "pause" : "play"));
      toggle.title = now.playing ? "Pause scene time" : "Play scene time";
      toggle.setAttribute("aria-label", toggle.title);
    }
    const text = clockText(time_s);
    if (clock.value !== text) clock.value = text;
    if (!held) {
      slider.max = Math.max(MIN_RANGE_S, Math.ceil((time_s + 1) / ROUND_S) * ROUND_S);
      slider.value = time_s;
    }
    slider.setAttribute("aria-valuetext", text);
    if (speed.dataset.speed !== String(now.speed)) {
      speed.dataset.speed = now.speed;
      const known = [...new Set([...SPEEDS, now.speed])].sort((a, b) => a - b);
      speed.replaceChildren(...known.map((each) => h("option", { value: each, selected: each === now.speed }, `${each}×`)));
    }
  }

  async function change(body) {
    sending = true;
    const reply = await command(typeof camera === "function" ? camera() : camera, "/time", body, "PATCH");
    sending = false;
    speed.dataset.speed = ""; // redraw the menu, in case the server refused the change
    if (reply) { now = reply; at = performance.now(); }
    draw();
  }

  const step = (by) => change({ time_s: Math.min(LATEST_S, Math.max(0, present() + by)) });

  // The scene follows the slider while it is dragged. Only the newest position is sent.
  async function seek() {
    pendingTime = Number(slider.value);
    if (sending) return;
    while (pendingTime !== null) {
      const time_s = pendingTime;
      pendingTime = null;
      await change({ time_s });
    }
  }

  slider.addEventListener("input", () => { dragged = true; draw(); seek(); });
  slider.addEventListener("change", () => { dragged = false; seek(); });
  setInterval(() => { if (now.playing && element.offsetParent) draw(); }, 100);
  return { element, update };
}

// The scene time below the live view. A click opens the controls.
export function makeStageTime() {
  const times = makeSceneTime(() => shared.camera);
  const read = h("span", { className: "clock" });
  const summary = h("summary", { title: "Scene time: pause, seek, speed" }, icon("clock"), read);
  const element = h("details", { className: "stage-time popup", hidden: true }, summary, h("div", { className: "sheet" }, h("h2", {}, "Scene time"), times.element));
  let sceneTime = null, shown = "";

  element.addEventListener("keydown", (event) => {
    if (event.key === "Escape" && element.open) { element.open = false; summary.focus(); }
  });
  addEventListener("pointerdown", (event) => { if (!element.contains(event.target)) element.open = false; });
  on("status", (status) => {
    sceneTime = status.scene_time ?? null;
    element.hidden = !sceneTime;
    element.classList.toggle("stopped", sceneTime?.playing === false);
  });
  on("frame", (facts) => {
    if (!sceneTime) return;
    times.update({ ...sceneTime, time_s: facts.time_s });
    const text = `${clockText(facts.time_s).slice(0, -2)}${sceneTime.playing ? (sceneTime.speed === 1 ? "" : ` · ${sceneTime.speed}×`) : " · paused"}`;
    if (text !== shown) { shown = text; read.textContent = text; }
  });
  on("camera", () => { sceneTime = null; element.hidden = true; element.open = false; });
  return element;
}
