// @ts-check
/** What stands in the world, and what moves whatever the robot does: where it is at an instant. `Route` of the plant says the same in Rust. */
import { place } from './geometry.js';

/** @typedef {import('./types.js').Mover} Mover */
/** @typedef {import('./types.js').Pose} Pose */

/**
 * @param {Mover} mover
 * @param {number} t_s Simulated time.
 * @returns {Pose}
 */
export function poseOf({ waypoints, repeat, start_s }, t_s) {
  const length_s = waypoints.at(-1)?.t_s ?? 0;
  const along_s = alongRoute(Math.max(t_s - start_s, 0), length_s, repeat);
  const index = Math.max(waypoints.findIndex((waypoint) => waypoint.t_s > along_s), 0) || waypoints.length - 1;
  const [from, to] = [waypoints[index - 1], waypoints[index]];
  if (!from || !to) return { x_m: 0, y_m: 0, heading_rad: 0 };
  const share = (along_s - from.t_s) / (to.t_s - from.t_s);
  /** @param {number} a @param {number} b */
  const between = (a, b) => a + share * (b - a);
  return {
    x_m: between(from.at.x_m, to.at.x_m),
    y_m: between(from.at.y_m, to.at.y_m),
    heading_rad: between(from.at.heading_rad, to.at.heading_rad),
  };
}

/** @param {number} since_s @param {number} length_s @param {Mover['repeat']} repeat */
function alongRoute(since_s, length_s, repeat) {
  if (repeat === 'once') return Math.min(since_s, length_s);
  if (repeat === 'loop') return since_s % length_s;
  const there_s = since_s % (2 * length_s);
  return there_s < length_s ? there_s : 2 * length_s - there_s;
}

/**
 * Outlines of all that stands, then of all that moves, by their numbers in the world; some were put elsewhere by a hand.
 * @param {import('./types.js').Scene | null} scene
 * @param {{placeOf: (thing: string, t_s: number) => Pose | null}} readings
 * @param {number} t_s Simulated time.
 * @returns {import('./types.js').Obstacle[]}
 */
export function inWorld(scene, readings, t_s) {
  const moving = (scene?.movers ?? []).map((mover) => {
    const at = poseOf(mover, t_s);
    return { corners_m: mover.corners_m.map((corner) => place(at, corner)), closed: true };
  });
  return [...scene?.obstacles ?? [], ...moving].map((each, number) => {
    const by = readings.placeOf(`thing${number}`, t_s);
    return by ? { ...each, corners_m: each.corners_m.map(([x, y]) => [x + by.x_m, y + by.y_m]) } : each;
  });
}
