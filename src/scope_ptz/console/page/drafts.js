// A dialog that lists benchmark task drafts made from runs with good feedback, and states why other runs cannot become drafts.

import { get, url } from "./api.js";
import { displayName } from "./benchmark_labels.js";
import { h, icon, iconButton } from "./dom.js";

// Open the dialog for the runs that match a query. Its link downloads the drafts.
export async function openDrafts(query) {
  const body = h("div", { className: "draft-body", tabIndex: 0, role: "region", "aria-label": "Drafts" }, h("p", { className: "muted" }, "Reading the runs …"));
  const dialog = h("dialog", { className: "viewer drafts", "aria-label": "Drafts of benchmark tasks", onclose: () => dialog.remove() },
    h("div", { className: "row" }, h("h2", {}, "Drafts of benchmark tasks"), h("span", { className: "space" }), iconButton("close", "Close", () => dialog.close())), body);
  document.querySelector("#scope").append(dialog);
  dialog.showModal();
  try {
    const rows = await get(`/runs/drafts?${query}`);
    body.replaceChildren(...(rows.length ? describe(rows, query) : [h("p", {}, "None of the listed runs has good feedback yet."), h("p", { className: "muted" }, "Rate runs as good to turn them into drafts.")]));
  } catch (error) {
    body.replaceChildren(h("p", { className: "problem" }, error.message));
  }
}

function describe(rows, query) {
  const good = rows.filter((each) => each.draft).length;
  return [h("p", {}, `${good} of ${rows.length} ${rows.length === 1 ? "run" : "runs"} with good feedback can become ${good === 1 ? "a draft" : "drafts"}. The command below validates the drafts against the ground truth and keeps the valid ones.`),
    h("ul", { className: "draft-list" }, rows.map((each) => h("li", { className: each.draft ? "" : "not" }, icon(each.draft ? "good" : "close"),
      h("div", {}, h("p", { className: "what" }, each.instruction || each.run), h("p", { className: "muted" }, each.draft ? `${displayName(each.draft.category)}, from preset ${each.draft.start} in ${each.scene}` : each.reason))))),
    h("div", { className: "row" }, h("code", {}, "scope bench drafts drafts.jsonl --out FOLDER"), h("span", { className: "space" }),
      h("a", { className: "button primary", href: url(`/runs/export?format=drafts&${query}`), download: "drafts.jsonl" }, "Download"))];
}
