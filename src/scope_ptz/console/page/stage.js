// The live view: frames from a WebSocket, marks on top of them, and the manual camera controls.

import { command, get, part, tabId, url } from "./api.js";
import { emit, on, shared } from "./app_state.js";
import { h, icon, iconButton } from "./dom.js";
import { drawMarks } from "./marks.js";
import { makeStageTime } from "./scene_time.js";

const DRAG_PX = 8; // shorter drags count as clicks
const REPEAT_MS = 200; // time between commands while a key is held
const KEYS = {
  ArrowLeft: [-1, 0, 0], ArrowRight: [1, 0, 0], ArrowUp: [0, 1, 0], ArrowDown: [0, -1, 0],
  "+": [0, 0, 1], "=": [0, 0, 1], "-": [0, 0, -1],
};

export function makeStage() {
  const canvas = h("canvas", { width: 1280, height: 720, className: "picture" });
  const overlay = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  overlay.setAttribute("class", "overlay");
  const band = h("div", { className: "band", hidden: true });
  const wait = h("div", { className: "wait" }, h("p", {}, "Connecting to the camera …"));
  const picture = h("div", { className: "view", tabIndex: 0, role: "application",
    "aria-label": "Live view. Arrow keys move, plus and minus zoom, H goes home, U undoes, Space stops." },
  canvas, overlay, band, wait);
  const read = h("dl", { className: "readout" });
  const rate = h("span", { className: "rate" });
  const stop = h("button", { type: "button", className: "stop", title: "Stop the camera and the instruction (Space)", onclick: halt },
    icon("stop"), "Stop");
  const pad = h("div", { className: "pad", role: "group", "aria-label": "Manual control" },
    hold("left", "Left"), h("span", { className: "column" }, hold("up", "Up"), hold("down", "Down")), hold("right", "Right"),
    h("span", { className: "column" }, hold("plus", "Zoom in"), hold("minus", "Zoom out")),
    iconButton("home", "Home view (H)", () => move("/home")), iconButton("undo", "Undo: return to the previous view (U)", () => move("/undo")));
  const hide = h("button", { type: "button", className: "chip", hidden: true, onclick: () => emit("marks", null) }, "Hide marks");
  const element = h("section", { className: "stage", "aria-label": "Camera" }, picture,
    h("div", { className: "bar" }, read, rate, makeStageTime(), hide, h("span", { className: "space" }), pad, stop));

  let socket = null, retry = 0, shown = "", marks = null, ends = [], delays = [], drawn = null;

  function hold(name, label) {
    const vector = { left: KEYS.ArrowLeft, right: KEYS.ArrowRight, up: KEYS.ArrowUp, down: KEYS.ArrowDown,
      plus: KEYS["+"], minus: KEYS["-"] }[name];
    const button = iconButton(name, label, (event) => { if (event.detail === 0) drive(vector, 0.4); });
    button.addEventListener("pointerdown", () => begin(label, vector));
    for (const end of ["pointerup", "pointerleave", "pointercancel"]) button.addEventListener(end, () => finish(label));
    return button;
  }

  function connect() {
    const camera = shared.camera;
    clearTimeout(retry);
    socket?.close();
    const scheme = location.protocol === "https:" ? "wss" : "ws";
    // One of two widths, so that viewers with windows of different sizes share one encoding.
    const wide = element.clientWidth * Math.min(devicePixelRatio, 2) > 640 ? 1280 : 640;
    const opened = (socket = new WebSocket(`${scheme}://${location.host}${url(`/cameras/${part(camera)}/live?width=${wide}&client=${tabId()}`)}`));
    opened.binaryType = "arraybuffer";
    opened.onmessage = async (event) => {
      if (typeof event.data === "string") {
        if (opened === socket) receive(JSON.parse(event.data).state);
        return;
      }
      await draw(event.data, opened);
      if (opened.readyState === WebSocket.OPEN) opened.send("drawn");
    };
    opened.onclose = (event) => {
      if (opened !== socket) return;
      showMessage(event.reason || "The connection was lost. Reconnecting …", true);
      get("/me").catch(() => {}); // without a valid session, this leads to the sign-in page
      retry = setTimeout(connect, 1500);
    };
  }

  function showMessage(text, failed = false) {
    wait.hidden = !text;
    wait.classList.toggle("failed", failed);
    wait.firstChild.textContent = text;
  }

  function receive(state) {
    shared.running = state.run;
    element.classList.toggle("busy", Boolean(state.run));
    if (state.problem) showMessage(`No picture: ${state.problem}`, true);
    emit("status", state);
  }

  async function draw(data, opened) {
    const length = new DataView(data).getUint32(0);
    const facts = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, length)));
    const bitmap = await createImageBitmap(new Blob([new Uint8Array(data, 4 + length)], { type: "image/jpeg" }));
    if (opened !== socket) { bitmap.close(); return; }
    if (canvas.width !== bitmap.width || canvas.height !== bitmap.height) {
      canvas.width = bitmap.width;
      canvas.height = bitmap.height;
      picture.style.aspectRatio = `${bitmap.width} / ${bitmap.height}`;
    }
    canvas.getContext("2d", { alpha: false }).drawImage(bitmap, 0, 0);
    bitmap.close();
    if (!wait.hidden) showMessage("");
    shared.live = drawn = facts;
    measure(facts);
    readOut(facts.pose);
    drawMarks(overlay, marks, facts);
    emit("frame", facts);
  }

  function measure(facts) {
    const now = performance.now();
    ends.push(now);
    delays.push(Date.now() - facts.taken * 1000);
    while (ends.length > 1 && now - ends[0] > 2000) { ends.shift(); delays.shift(); }
    if (facts.number % 12) return;
    const fps = ends.length > 1 ? ((ends.length - 1) * 1000) / (now - ends[0]) : 0;
    const delay = [...delays].sort((a, b) => a - b)[Math.floor(delays.length / 2)];
    rate.textContent = `${fps.toFixed(0)} frames/s`;
    rate.title = `${Math.max(0, delay).toFixed(0)} ms from the camera to the screen`;
    Object.assign(element.dataset, { fps: fps.toFixed(1), delayMs: delay.toFixed(0), frame: facts.number });
  }

  function readOut(pose) {
    const sign = (value) => `${value < -0.05 ? "−" : "+"}${Math.abs(value).toFixed(1)}°`;
    const text = [sign(pose.pan_deg), sign(pose.tilt_deg), `${pose.zoom.toFixed(1)}×`];
    if (text.join() === shown) return;
    shown = text.join();
    read.replaceChildren(...["Pan", "Tilt", "Zoom"].flatMap((name, i) => [h("div", {}, h("dt", {}, name), h("dd", {}, text[i]))]));
  }

  async function move(path, body) {
    const arrival = await command(shared.camera, path, body);
    if (arrival?.limited_by) emit("limited", arrival.limited_by);
  }

  function halt() {
    emit("stopping");
    return command(shared.camera, "/stop");
  }

  function drive([pan, tilt, zoom], timeout_s = 0.5) {
    const top = shared.state?.top_speed ?? { pan_dps: 60, tilt_dps: 60, zoom_rate: 1 };
    const speed = (shared.live?.hfov_deg ?? 60) * 0.6; // slower in a narrow view
    return command(shared.camera, "/drive", { pan_dps: pan * Math.min(speed, top.pan_dps), tilt_dps: tilt * Math.min(speed, top.tilt_dps),
      zoom_rate: zoom * Math.min(1, top.zoom_rate), timeout_s });
  }

  // Keys and buttons that are held ---------------------------------------------------------------------------------------
  const held = new Map();
  let ticking = 0;

  function begin(key, vector) {
    held.set(key, vector);
    if (!ticking) { tick(); ticking = setInterval(tick, REPEAT_MS); }
  }

  function finish(key) {
    if (!held.delete(key) || held.size) return;
    clearInterval(ticking);
    ticking = 0;
    drive([0, 0, 0], 0.1);
  }

  function tick() {
    const sum = [...held.values()].reduce((a, b) => a.map((each, i) => each + b[i]), [0, 0, 0]);
    drive(sum.map(Math.sign));
  }

  addEventListener("keydown", (event) => {
    const typing = event.target.closest?.("input, textarea, select, dialog, .popup[open]");
    if (typing || event.ctrlKey || event.metaKey || event.altKey) return;
    event.stopImmediatePropagation(); // Streamlit has its own key bindings
    // On other views, where the picture cannot be seen, keys only stop the camera.
    if (!element.offsetParent && !["Escape", " "].includes(event.key)) return;
    const onButton = event.target.closest?.("button, a, summary");
    if (event.key === "Escape" || (event.key === " " && !onButton)) halt();
    else if (event.key in KEYS && !event.repeat) begin(event.key, KEYS[event.key]);
    else if (event.key === "h") move("/home");
    else if (event.key === "u") move("/undo");
    else if (!(event.key in KEYS)) return;
    event.preventDefault();
  }, true);
  addEventListener("keyup", (event) => finish(event.key), true);
  addEventListener("blur", () => [...held.keys()].forEach(finish));

  // Click, drag and wheel ------------------------------------------------------------------------------------------------
  let start = null, wheeled = 0;
  const at = (event) => {
    const box = canvas.getBoundingClientRect();
    const clip = (value) => Math.min(1, Math.max(0, value));
    return { x: clip((event.clientX - box.left) / box.width), y: clip((event.clientY - box.top) / box.height), px: event.clientX, py: event.clientY };
  };
  picture.addEventListener("pointerdown", (event) => {
    if (event.button || !drawn) return;
    picture.setPointerCapture(event.pointerId);
    start = { ...at(event), pose: drawn.pose };
  });
  picture.addEventListener("pointermove", (event) => {
    if (!start) return;
    const end = at(event);
    band.hidden = Math.hypot(end.px - start.px, end.py - start.py) < DRAG_PX;
    Object.assign(band.style, { left: `${Math.min(start.x, end.x) * 100}%`, top: `${Math.min(start.y, end.y) * 100}%`,
      width: `${Math.abs(end.x - start.x) * 100}%`, height: `${Math.abs(end.y - start.y) * 100}%` });
  });
  picture.addEventListener("pointercancel", () => { start = null; band.hidden = true; });
  picture.addEventListener("pointerup", (event) => {
    if (!start) return;
    const from = start, to = at(event);
    start = null;
    band.hidden = true;
    if (Math.hypot(to.px - from.px, to.py - from.py) < DRAG_PX) move("/centre", { x: from.x, y: from.y, pose: from.pose });
    else move("/frame-box", { x_min: Math.min(from.x, to.x), y_min: Math.min(from.y, to.y), x_max: Math.max(from.x, to.x),
      y_max: Math.max(from.y, to.y), pose: from.pose });
  });
  picture.addEventListener("wheel", (event) => {
    event.preventDefault();
    const now = performance.now();
    if (now - wheeled < 120 || !event.deltaY) return;
    wheeled = now;
    drive([0, 0, event.deltaY < 0 ? 1 : -1], 0.25);
  }, { passive: false });

  on("marks", (value) => {
    marks = value;
    hide.hidden = !value;
    drawMarks(overlay, marks, drawn);
  });
  on("camera", () => {
    emit("marks", null);
    clearTimeout(retry);
    socket?.close();
    socket = null;
    read.replaceChildren();
    rate.textContent = shown = "";
    showMessage("Connecting to the camera …");
  });
  on("state", (state) => { if (!socket && state.name === shared.camera) connect(); });
  on("unavailable", (message) => { if (!socket) showMessage(message, true); });
  return element;
}
