// Convert between directions and image points. Angles are in degrees, positive to the right and up; points are fractions of
// the image size from the top left.

const RAD = Math.PI / 180;

function axes(pose) {
  const p = pose.pan_deg * RAD, t = pose.tilt_deg * RAD;
  return {
    forward: [Math.cos(t) * Math.sin(p), Math.sin(t), Math.cos(t) * Math.cos(p)],
    right: [Math.cos(p), 0, -Math.sin(p)],
    up: [-Math.sin(t) * Math.sin(p), Math.cos(t), -Math.sin(t) * Math.cos(p)],
  };
}

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

// The direction of an image point.
export function directionOf(x, y, pose, hfov_deg, aspect) {
  const { forward, right, up } = axes(pose), k = Math.tan((hfov_deg / 2) * RAD);
  const a = (2 * x - 1) * k, b = ((1 - 2 * y) * k) / aspect;
  const v = [0, 1, 2].map((i) => forward[i] + a * right[i] + b * up[i]);
  const length = Math.sqrt(dot(v, v));
  return v.map((each) => each / length);
}

// The image point at which a direction appears; null for directions behind the camera.
export function pointOf(direction, pose, hfov_deg, aspect) {
  const { forward, right, up } = axes(pose), k = Math.tan((hfov_deg / 2) * RAD);
  const depth = dot(direction, forward);
  if (depth < 0.05) return null;
  return { x: 0.5 + dot(direction, right) / depth / k / 2, y: 0.5 - (dot(direction, up) / depth / k / 2) * aspect };
}

export function panTiltOf(direction) {
  return { pan_deg: Math.atan2(direction[0], direction[2]) / RAD, tilt_deg: Math.asin(direction[1]) / RAD };
}

// The horizontal field of view in degrees at a magnification, interpolated in the optics table.
export function fieldOfView(table, zoom) {
  if (!table?.length) return 60; // a typical field of view, until the table is known
  if (zoom <= table[0][0]) return table[0][1];
  for (let i = 1; i < table.length; i++) {
    const [z1, f1] = table[i];
    if (zoom > z1) continue;
    const [z0, f0] = table[i - 1], k = (zoom - z0) / (z1 - z0);
    const t0 = 1 / Math.tan((f0 / 2) * RAD), t1 = 1 / Math.tan((f1 / 2) * RAD);
    return (2 * Math.atan(1 / (t0 + k * (t1 - t0)))) / RAD;
  }
  return table.at(-1)[1];
}
