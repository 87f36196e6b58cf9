// The Cameras tab: a card for each of the server's cameras, with its picture, abilities, controller and health.

import { get, part, url } from "./api.js";
import { emit, on, shared } from "./app_state.js";
import { controlText } from "./control_text.js";
import { h, icon } from "./dom.js";
import { makeSceneTime } from "./scene_time.js";
import { makeVirtualCamera } from "./virtual_camera.js";

const REFRESH_MS = 3000;
const KINDS = { simulated: "Scene", blender: "Live Blender", axis: "AXIS camera", onvif: "ONVIF camera", plug_in: "Plug-in camera" };
const ABILITIES = { move: "moves", drive: "drives", presets: "saves presets", focus: "focus", iris: "iris", scene_time: "scene time", ground_truth: "ground truth",
  virtual_camera: "virtual camera" };
const HEALTH = { connected: "Connected", ready: "Ready", failed: "Not available" };

let pictures = Promise.resolve();

export function makeCameras() {
  const site = h("div", { className: "cards" }), scenes = h("div", { className: "cards" }), problem = h("p", { className: "problem", role: "alert" });
  const none = h("p", { className: "empty" }, "scope.yaml does not define any cameras yet. ", h("code", {}, "scope camera discover"),
    " finds cameras on the network. Add them to the file and restart the console.");
  const element = h("section", { className: "page cameras", "aria-label": "Cameras", hidden: true }, h("h1", {}, "Cameras"),
    h("p", { className: "lead" }, "This page shows one camera at a time. Each camera has its own conversation."), problem,
    h("h2", {}, "Cameras of this site"), site, none, h("h2", {}, "Scenes"), scenes);
  const cards = new Map(), pending = new Set();
  let timer = 0, showing = false;

  async function refresh() {
    clearTimeout(timer);
    if (!showing) return;
    if (!document.hidden) await load();
    clearTimeout(timer);
    if (showing) timer = setTimeout(refresh, REFRESH_MS);
  }

  async function load() {
    try {
      const names = (await get("/cameras")).map((each) => each.name);
      problem.textContent = "";
      for (const name of names) if (!cards.has(name)) cards.set(name, null);
      // Load the cards separately, so that a camera that does not answer does not delay the others.
      await Promise.race([Promise.allSettled(names.filter((name) => !pending.has(name)).map(show)), new Promise((resolve) => setTimeout(resolve, REFRESH_MS))]);
    } catch (error) {
      problem.textContent = error.message;
    }
  }

  async function show(name) {
    pending.add(name); // do not request the card again while the camera does not answer
    const facts = await get(`/cameras/${part(name)}/card`).finally(() => pending.delete(name));
    if (!cards.get(name)) {
      const created = makeCard(facts, refresh);
      cards.set(name, created);
      const list = facts.configured ? site : scenes;
      list.append(created.element);
      // Keep the server's order, regardless of which card arrives first.
      const order = [...cards.keys()];
      list.append(...[...list.children].sort((a, b) => order.indexOf(a.dataset.name) - order.indexOf(b.dataset.name)));
      none.hidden = Boolean(site.children.length);
    }
    cards.get(name).update(facts);
  }

  on("show", (name) => {
    showing = name === "cameras";
    element.hidden = !showing;
    refresh();
  });
  on("camera", () => { for (const card of cards.values()) card?.mark(); });
  document.addEventListener("visibilitychange", () => { if (!document.hidden) refresh(); });
  return element;
}

function makeCard(first, refresh) {
  const name = first.name;
  const image = h("img", { alt: "", hidden: true }), blank = h("span", { className: "blank" }, icon("camera"));
  const go = () => { if (shared.camera !== name) emit("choose", name); emit("go", "live"); };
  const picture = h("button", { type: "button", className: "shot", title: `Show ${name}`, "aria-label": `Show ${name}`, onclick: go }, blank, image);
  const health = h("p", { className: "state" }), problem = h("p", { className: "why" }), who = h("p", { className: "muted" });
  const facts = h("p", { className: "muted" }), abilities = h("ul", { className: "abilities", "aria-label": "Abilities" });
  const select = h("button", { type: "button", onclick: go });
  const again = h("button", { type: "button", className: "link", hidden: true, "aria-label": `Try ${name} again`, onclick: refresh }, "Try again");
  const time = first.abilities.includes("scene_time") ? makeSceneTime(name) : null;
  const virtual = first.abilities.includes("virtual_camera") ? makeVirtualCamera(name, first.scene?.viewpoints ?? []) : null;
  const later = h("p", { className: "hint" }, "Scene time starts when the camera is used.");
  const element = h("article", { className: "card", "data-name": name, "aria-label": name }, picture,
    h("div", { className: "body" }, h("div", { className: "row" }, h("h3", {}, name), h("span", { className: "space" }), health), facts, problem, abilities,
      h("div", { className: "row control-row" }, who, again, h("span", { className: "space" }), select),
      time && h("div", { className: "time" }, time.element, later), virtual?.element));
  let listed = "", drawing = false;

  function update(card) {
    const failed = card.health.state === "failed";
    element.dataset.health = card.health.state;
    health.textContent = HEALTH[card.health.state];
    health.className = `state ${card.health.state}`;
    problem.textContent = failed ? card.health.problem.message : "";
    problem.hidden = again.hidden = !failed;
    facts.textContent = describe(card);
    const now = JSON.stringify(card.abilities);
    if (now !== listed) {
      listed = now;
      abilities.replaceChildren(...card.abilities.map((each) => h("li", {}, ABILITIES[each])));
    }
    abilities.hidden = !card.abilities.length;
    who.textContent = card.run ? "An instruction is in progress." : card.control.mine ? "You are in control."
      : card.control.holder ? controlText(card.control.holder) : failed ? "" : "Nobody is in control.";
    if (time) {
      time.element.hidden = !card.scene_time;
      later.hidden = Boolean(card.scene_time);
      if (card.scene_time) time.update(card.scene_time);
    }
    virtual?.update(card.virtual_camera);
    if (card.has_picture && (card.open || image.hidden)) draw();
    if (!card.has_picture) { image.hidden = true; blank.hidden = false; }
    mark();
  }

  // The old picture stays until the new one is loaded, which avoids flicker. All cards together request one picture at a time, because
  // the server has to render the pictures of scenes that have not been used yet.
  function draw() {
    if (drawing) return;
    drawing = true;
    pictures = pictures.then(() => new Promise((done) => {
      const next = new Image();
      next.onload = () => { image.src = next.src; image.hidden = false; blank.hidden = true; done(); };
      next.onerror = done;
      next.src = `${url(`/cameras/${part(name)}/thumbnail`)}?at=${Date.now()}`;
    })).then(() => { drawing = false; });
  }

  function mark() {
    const selected = shared.camera === name;
    element.classList.toggle("current", selected);
    select.textContent = selected ? "Shown on this page" : "Show";
    select.setAttribute("aria-label", selected ? `${name} is shown on this page` : `Show ${name} on this page`);
    if (selected) element.setAttribute("aria-current", "true");
    else element.removeAttribute("aria-current");
  }

  return { element, update, mark };
}

function describe(card) {
  const { scene } = card, some = (count, one, many) => (count === 1 ? `1 ${one}` : `${count} ${many}`);
  if (!scene) return [KINDS[card.kind], card.title].filter(Boolean).join(" · ");
  const title = scene.title.toLowerCase().replaceAll(" ", "-") === card.name ? "" : scene.title; // do not repeat the name
  return [title, some(scene.viewpoints.length, "viewpoint", "viewpoints"), some(scene.presets, "preset", "presets"),
    some(scene.moving, "moving object", "moving objects")].filter(Boolean).join(" · ");
}
