// The page: its header, its views, and the camera selection.

import { command, get, part, request as send } from "./api.js";
import { emit, on, shared } from "./app_state.js";
import { makeBenchmark } from "./benchmark.js";
import { makeCameras } from "./cameras.js";
import { controlText, requestText } from "./control_text.js";
import { h, iconButton, setNoticeArea, notify } from "./dom.js";
import { makeMap } from "./map.js";
import { makePanel } from "./panel.js";
import { makePresets } from "./presets.js";
import { makeRuns } from "./runs.js";
import { makeStage } from "./stage.js";
import { makeTimings } from "./timings.js";

const RETRY_MS = 4000; // delay before a failed camera is retried
const VIEWS = [["live", "Live"], ["runs", "Runs"], ["timings", "Timings"], ["benchmark", "Benchmark"], ["cameras", "Cameras"]];

export async function mount(root) {
  theme(localStorage.getItem("scope-theme"));
  const notices = h("div", { className: "notices", role: "status" });
  setNoticeArea(notices);
  const cameras = h("select", { className: "camera", "aria-label": "Camera", onchange: () => choose(cameras.value) });
  const control = h("p", { className: "control" }), signOut = h("a", { href: "#", hidden: true, onclick: endSession }, "Sign out");
  const tabs = VIEWS.map(([name, label]) => h("button", { type: "button", onclick: () => show(name), value: name }, label));
  const head = h("header", { className: "head" }, h("span", { className: "brand" }, "SCOPE"), cameras, h("nav", { "aria-label": "Views" }, tabs),
    h("span", { className: "space" }), control, signOut, iconButton("theme", "Switch between light and dark", () => theme(isDark() ? "light" : "dark"), { id: "theme" }));
  const live = h("div", { className: "live" }, makeStage(), h("div", { className: "below" }, makePresets(), makeMap()), makePanel());
  root.replaceChildren(head, h("div", { className: "views" }, live, makeRuns(), makeTimings(), makeBenchmark(), makeCameras()), notices);

  let inControl = false; // whether this tab controls the camera
  let trying = 0;

  // Give up control when the tab leaves a camera. `keepalive` lets the request outlive the page.
  function release() {
    if (inControl) send("DELETE", `/cameras/${part(shared.camera)}/control`, undefined, { keepalive: true }).catch(() => {});
    inControl = false;
  }

  function show(name) {
    live.hidden = name !== "live";
    for (const tab of tabs) tab.setAttribute("aria-current", tab.value === name ? "page" : "false");
    emit("show", name);
  }

  async function choose(name) {
    release();
    shared.camera = cameras.value = name;
    localStorage.setItem("scope-camera", name);
    shared.state = shared.live = shared.running = null;
    control.replaceChildren();
    emit("camera", name);
    await enter(name);
  }

  // The stage shows why a camera is not available, and the page keeps retrying.
  async function enter(name) {
    clearTimeout(trying);
    try {
      const { health } = await get(`/cameras/${part(name)}/card`);
      const state = health.state === "failed" ? null : await get(`/cameras/${part(name)}`);
      if (shared.camera !== name) return;
      if (!state) throw new Error(health.problem.message);
      shared.state = state;
      emit("state", state);
      showControl(state.control);
    } catch (error) {
      if (shared.camera !== name) return;
      emit("unavailable", error.message);
      trying = setTimeout(() => enter(name), RETRY_MS);
    }
  }

  function showControl(now) {
    inControl = now.mine;
    const asking = now.requests.find((each) => each.client !== shared.me?.client);
    const answer = (grant) => command(shared.camera, "/control/answer", { client: asking.client, grant }).then((value) => value && showControl(value));
    if (now.mine && asking) {
      control.replaceChildren(requestText(asking.name), h("button", { type: "button", onclick: () => answer(true) }, "Hand over"),
        h("button", { type: "button", onclick: () => answer(false) }, "Keep"));
    } else if (now.holder && !now.mine) {
      const waiting = now.requests.some((each) => each.client === shared.me?.client);
      control.replaceChildren(controlText(now.holder), waiting ? " You have asked for control." : h("button", { type: "button", onclick: () => command(shared.camera, "/control").then((value) => value && showControl(value)) }, "Ask for control"));
    } else {
      control.replaceChildren(now.mine ? "You are in control." : "");
    }
  }

  let changes = null;
  addEventListener("pagehide", release);
  on("status", async (status) => {
    const found = `${status.control} ${status.holder}`; // control that expires changes only the holder
    if (found === changes) return;
    changes = found;
    const name = shared.camera, now = await get(`/cameras/${part(name)}/control`).catch(() => null);
    if (now && name === shared.camera) showControl(now);
  });
  on("go", show);
  on("choose", choose);
  on("limited", (reason) => notify(`The camera stopped early: ${reason}.`));
  show("live");
  try {
    const [me, server] = await Promise.all([get("/me"), get("/server")]);
    shared.me = me;
    signOut.hidden = !me.signs_in;
    cameras.replaceChildren(...server.cameras.map((name) => h("option", { value: name }, name)));
    const last = localStorage.getItem("scope-camera");
    await choose(server.cameras.includes(last) ? last : server.cameras[0]);
  } catch (error) {
    notify(error.message, ["Try again", () => location.reload()]);
  }
}

async function endSession(event) {
  event.preventDefault();
  await fetch("/api/v1/session", { method: "DELETE" });
  location.assign("/sign-in");
}

const isDark = () => (document.documentElement.dataset.scopeTheme ?? (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light")) === "dark";

function theme(name) {
  if (name === "light" || name === "dark") {
    document.documentElement.dataset.scopeTheme = name;
    localStorage.setItem("scope-theme", name);
  }
  emit("theme");
}
