// Requests to the API. Each browser tab is one client and stays the same client after a reload.

import { notify } from "./dom.js";

const ROOT = "/api/v1";

export function tabId() {
  let id = sessionStorage.getItem("scope-tab");
  if (!id) {
    id = Array.from(crypto.getRandomValues(new Uint8Array(9)), (byte) => byte.toString(16).padStart(2, "0")).join("");
    sessionStorage.setItem("scope-tab", id);
  }
  return id;
}

export class ApiError extends Error {
  constructor(status, code, message) {
    super(message);
    this.status = status;
    this.code = code;
  }
}

export const url = (path) => ROOT + path;
export const part = encodeURIComponent;

export async function request(method, path, body, options = {}) {
  const headers = { "Scope-Client": tabId() };
  if (body !== undefined) headers["Content-Type"] = "application/json";
  let reply;
  try {
    reply = await fetch(ROOT + path, { ...options, method, headers, body: body === undefined ? undefined : JSON.stringify(body) });
  } catch {
    throw new ApiError(0, "offline", "The server is not responding. Check that it is running.");
  }
  if (reply.status === 401) location.assign("/sign-in");
  const text = await reply.text();
  const data = text ? JSON.parse(text) : null;
  if (!reply.ok) throw new ApiError(reply.status, data?.error?.code ?? "", data?.error?.message ?? `The server replied with status ${reply.status}.`);
  return data;
}

export const get = (path) => request("GET", path);
export const post = (path, body) => request("POST", path, body);

// Send a manual command. An error is shown as a notice, with a button that resolves it where possible.
export async function command(camera, path, body, method = "POST") {
  const base = `/cameras/${part(camera)}`;
  try {
    return await request(method, base + path, body);
  } catch (error) {
    if (error.code === "not_in_control") notify(error.message, ["Ask for control", () => command(camera, "/control")]);
    else if (error.code === "busy") notify("An instruction is in progress.", ["Stop it", () => command(camera, "/stop")]);
    else notify(error.message);
    return undefined;
  }
}

// Follow a run from its first record. `on` maps record names to handlers. `on.lost(state)` is called if the run was interrupted;
// `state` is null if the server does not know the run.
export function follow(run, on) {
  const source = new EventSource(`${ROOT}/runs/${part(run)}/events`);
  for (const name of ["start", "decision", "call", "end"]) {
    source.addEventListener(name, (event) => {
      if (name === "end") source.close();
      on[name]?.(JSON.parse(event.data));
    });
  }
  source.onerror = async () => {
    // The browser reconnects automatically. A run that was interrupted never sends its end, so stop following it.
    try {
      const state = await get(`/runs/${part(run)}`);
      if (!state.running && state.outcome === "unfinished") { source.close(); on.lost?.(state); }
    } catch (error) {
      if (error.status === 404) { source.close(); on.lost?.(null); }
    }
  };
  return source;
}
