// @ts-check
/** Poses in frames: x forward, y left, counter-clockwise headings. */

/** @typedef {import('./types.js').Pose} Pose */

/** Of two degrees of freedom. */
const CHI_SQUARE_95 = 5.991;

/** @type {Pose} */
export const IDENTITY = { x_m: 0, y_m: 0, heading_rad: 0 };

/**
 * A pose in `frame`, in the frame around it.
 * @param {Pose} frame
 * @param {Pose} at
 * @returns {Pose}
 */
export function compose(frame, at) {
  const cos = Math.cos(frame.heading_rad);
  const sin = Math.sin(frame.heading_rad);
  return {
    x_m: frame.x_m + cos * at.x_m - sin * at.y_m,
    y_m: frame.y_m + sin * at.x_m + cos * at.y_m,
    heading_rad: wrapped(frame.heading_rad + at.heading_rad),
  };
}

/**
 * The frame around `at`, as seen from there.
 * @param {Pose} at
 * @returns {Pose}
 */
export function inverse(at) {
  const cos = Math.cos(at.heading_rad);
  const sin = Math.sin(at.heading_rad);
  return { x_m: -cos * at.x_m - sin * at.y_m, y_m: sin * at.x_m - cos * at.y_m, heading_rad: -at.heading_rad };
}

/**
 * A point in `frame`, in the frame around it.
 * @param {Pose} frame
 * @param {[number, number]} point
 * @returns {[number, number]}
 */
export function place(frame, [x_m, y_m]) {
  const at = compose(frame, { x_m, y_m, heading_rad: 0 });
  return [at.x_m, at.y_m];
}

/**
 * The same direction in (-pi, pi].
 * @param {number} angle_rad
 */
export function wrapped(angle_rad) {
  return Math.atan2(Math.sin(angle_rad), Math.cos(angle_rad));
}

/**
 * The same direction in degrees, near another angle.
 * @param {number} angle_deg
 * @param {number} other_deg
 */
export function near(angle_deg, other_deg) {
  return angle_deg + 360 * Math.round((other_deg - angle_deg) / 360);
}

/**
 * The 95 % ellipse of a position with these deviations: its half axes [m], and the direction of the first.
 * @param {import('./types.js').Spread} spread
 */
export function likelyArea({ x_m, y_m, correlation }) {
  const [xx, yy, xy] = [x_m * x_m, y_m * y_m, correlation * x_m * y_m];
  const middle = (xx + yy) / 2;
  const apart = Math.hypot((xx - yy) / 2, xy);
  /** @param {number} variance */
  const half_m = (variance) => Math.sqrt(CHI_SQUARE_95 * Math.max(variance, 0));
  return { half_m: [half_m(middle + apart), half_m(middle - apart)], direction_rad: Math.atan2(2 * xy, xx - yy) / 2 };
}

/**
 * The part of a wall next to a place: its nearest point, and as far as `along_m` to both sides of it.
 * @param {[number, number]} from @param {[number, number]} to @param {[number, number]} at @param {number} along_m
 * @returns {[number, number][]}
 */
export function nextTo(from, to, at, along_m) {
  const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
  const length_m = Math.hypot(dx, dy) || 1;
  const nearest_m = ((at[0] - from[0]) * dx + (at[1] - from[1]) * dy) / length_m;
  return [-along_m, 0, along_m].map((beside_m) => {
    const share = Math.min(1, Math.max(0, (nearest_m + beside_m) / length_m));
    return [from[0] + share * dx, from[1] + share * dy];
  });
}
