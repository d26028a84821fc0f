// @ts-check
/**
 * Geometry of a real robot, from its parameters: positions of its sonars and distance of its wheels. The same as
 * `Params::view` of the control core.
 */

/** @typedef {import('./types.js').Parameter} Parameter */
/** @typedef {import('./types.js').SonarMount} SonarMount */
/** @typedef {{base_m: number, wheel_radius_m: number, sonars: SonarMount[]}} Body */

const [LEFT, RIGHT, FRONT] = [0, 1, 2];
/** Length of the drawn beam of a sonar with a clear range [m]. */
const REACH_M = 2.5;

/**
 * @param {string} rig The rig's name.
 * @param {Parameter[]} parameters Values not received yet count as their defaults.
 * @returns {Body | null} Null: there is no such rig.
 */
export function bodyOf(rig, parameters) {
  const known = new Map(parameters.map(({ name, value, default: usual }) => [name, value ?? usual]));
  const of = (/** @type {string} */ name) => known.get(name) ?? 0;
  /** @param {number} id @param {number} x_m @param {number} y_m @param {number} quarters of a turn, from ahead @param {boolean} [on_servo] @returns {SonarMount} */
  const mount = (id, x_m, y_m, quarters, on_servo = false) =>
    ({ id, at: { x_m, y_m, heading_rad: quarters * Math.PI / 2 }, half_angle_rad: of('sonar_beam_rad'), reach_m: REACH_M, on_servo });
  const ahead_m = of('sonar_front_x_m');
  const [side_x_m, side_y_m] = [of('sonar_side_x_m'), of('sonar_side_y_m')];
  /** @param {number} side 1 left, -1 right */
  const pair = (side) => [LEFT, RIGHT].map((id) => mount(id, side_x_m + (id === LEFT ? 0.5 : -0.5) * of('side_gap_m'), side * side_y_m, side));
  /** @type {Record<string, () => SonarMount[]>} */
  const rigs = {
    front_single: () => [mount(FRONT, ahead_m, 0, 0)],
    front_pair: () => [LEFT, RIGHT].map((id) => mount(id, ahead_m, (id === LEFT ? 0.5 : -0.5) * of('front_gap_m'), 0)),
    side_pair_left: () => pair(1),
    side_pair_right: () => pair(-1),
    final: () => [mount(LEFT, side_x_m, side_y_m, 1), mount(RIGHT, side_x_m, -side_y_m, -1), mount(FRONT, ahead_m, 0, 0, true)],
  };
  const sonars = rigs[rig]?.();
  return sonars ? { base_m: of('base_m'), wheel_radius_m: (of('radius_left_m') + of('radius_right_m')) / 2, sonars } : null;
}
