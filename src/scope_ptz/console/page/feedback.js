// Buttons to rate or comment on a run or one of its steps.

import { part, post } from "./api.js";
import { askFor, iconButton, notify } from "./dom.js";

export function feedbackButtons(run, position = null) {
  const subject = position === null ? "this answer" : `step ${position + 1}`;
  let rating = 0, comment = "";

  async function send() {
    try {
      await post(`/runs/${part(run)}/feedback`, { rating, comment, ...(position === null ? {} : { position }) });
    } catch (error) {
      notify(error.message);
      return false;
    }
    good.setAttribute("aria-pressed", rating === 1);
    bad.setAttribute("aria-pressed", rating === -1);
    note.setAttribute("aria-pressed", Boolean(comment));
    return true;
  }

  async function rate(value) {
    const before = rating;
    rating = value;
    if (!(await send())) rating = before;
  }

  async function write() {
    const text = await askFor({ title: `Comment on ${subject}`, value: comment, maxLength: 500 });
    if (text === null) return;
    const before = comment;
    comment = text;
    if (!(await send())) comment = before;
  }

  const good = iconButton("good", `Good: ${subject}`, () => rate(1), { "aria-pressed": "false" });
  const bad = iconButton("bad", `Bad: ${subject}`, () => rate(-1), { "aria-pressed": "false" });
  const note = iconButton("note", `Comment on ${subject}`, write, { "aria-pressed": "false" });
  return [good, bad, note];
}
