// Preset thumbnails, with commands to go to a preset, save the current view, and rename and remove presets.

import { command, get, part, url } from "./api.js";
import { emit, on, shared } from "./app_state.js";
import { askFor, h, icon, iconButton } from "./dom.js";

export function makePresets() {
  const list = h("ul", { className: "presets" });
  const add = h("button", { type: "button", className: "link", title: "Save the current view as a preset", onclick: save }, icon("plus"), "Save this view");
  const element = h("section", { className: "strip", "aria-label": "Presets" }, h("div", { className: "row" }, h("h2", {}, "Presets"), h("span", { className: "space" }), add), list);
  let changes = null, listed = "";

  async function save() {
    const name = await askFor({ title: "Save this view as a preset", label: "Name of the preset", value: "" });
    if (name && (await command(shared.camera, `/presets/${part(name)}`, {}, "PUT"))) refresh();
  }

  async function rename(name) {
    const changed = await askFor({ title: `Rename ${name}`, label: "The camera goes to the preset and back.", value: name, confirm: "Rename" });
    if (changed && changed !== name && (await command(shared.camera, `/presets/${part(name)}`, { name: changed }, "PATCH"))) refresh();
  }

  async function remove(name) {
    if (!(await askFor({ title: `Remove the preset ${name}?`, confirm: "Remove" }))) return;
    await command(shared.camera, `/presets/${part(name)}`, undefined, "DELETE");
    refresh();
  }

  async function go(name) {
    const known = shared.state?.presets.find((each) => each.name === name);
    if ((await command(shared.camera, `/presets/${part(name)}/go`)) && !(known?.pose && known.has_picture)) refresh(); // the server knows its pose after the visit
  }

  async function refresh() {
    const state = await get(`/cameras/${part(shared.camera)}`).catch(() => null);
    if (state) { shared.state = state; emit("state", state); }
  }

  function tile(preset, edits) {
    const source = url(`/cameras/${part(shared.camera)}/presets/${part(preset.name)}/thumbnail?change=${changes ?? 0}`);
    const image = h("img", { alt: "", loading: "lazy", src: preset.has_picture ? source : null, onerror: () => image.remove() });
    return h("li", {},
      h("button", { type: "button", className: "tile", title: preset.description || preset.name, onclick: () => go(preset.name) },
        h("span", { className: "thumb" }, preset.has_picture && image), h("span", { className: "name" }, preset.name)),
      edits && h("span", { className: "edit" },
        iconButton("pencil", `Rename ${preset.name}`, () => rename(preset.name)), iconButton("trash", `Remove ${preset.name}`, () => remove(preset.name))));
  }

  on("state", (state) => {
    add.hidden = !state.edits_presets;
    const now = JSON.stringify([state.name, state.presets, changes]);
    if (now === listed) return; // keep the keyboard focus
    listed = now;
    list.replaceChildren(...state.presets.map((each) => tile(each, state.edits_presets)));
    if (!state.presets.length) list.replaceChildren(h("li", { className: "empty" }, "No presets yet. Aim the camera, then choose \"Save this view\"."));
  });
  on("status", (status) => {
    if (changes !== null && status.presets !== changes) { changes = status.presets; refresh(); }
    changes = status.presets;
  });
  on("camera", () => { changes = null; listed = ""; add.hidden = true; list.replaceChildren(); });
  return element;
}
