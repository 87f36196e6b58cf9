// Messages that state who controls a camera and who requests control.

import { shared } from "./app_state.js";

const LOCAL = "local"; // the name of every client if the server has no tokens

export function controlText(holder) {
  if (holder === LOCAL) return "This computer is in control, in another window or program.";
  return holder === shared.me?.name ? `${holder} is in control, in another window.` : `${holder} is in control.`;
}

export const requestText = (name) => (name === LOCAL ? "Another window or program on this computer asks for control." : `${name} asks for control.`);
