// The shared state of the page, and the events that notify its modules of changes.

const listeners = new Map();

export const shared = {
  camera: "", // name of the selected camera
  state: null, // camera state, as returned by the API
  live: null, // pose, field of view, time and size of the newest frame
  running: null, // id of the run in progress
  me: null, // name, role and key of this client
};

export function on(event, listener) {
  if (!listeners.has(event)) listeners.set(event, []);
  listeners.get(event).push(listener);
}

export function emit(event, value) {
  for (const listener of listeners.get(event) ?? []) listener(value);
}
