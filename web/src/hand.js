// @ts-check
/**
 * A hand on the map: it takes the simulated robot, a box, a wall, a person or the goal, and puts it down elsewhere while all
 * runs on. What it does is a line to the lab (`crates/lab/src/hand.rs`), which logs have and a rerun repeats; a goal is the
 * robot's, set as by a click.
 */
import { IDENTITY, inverse, place } from './geometry.js';
import { inWorld } from './movers.js';
import { colours } from './theme.js';
import { isAt } from './world_shapes.js';

/** @typedef {import('./types.js').Scene} Scene */
/** @typedef {import('./types.js').Pose} Pose */
/** @typedef {import('./store.js').Store} Store */
/** @typedef {[number, number]} Point In the world [m]. */

/**
 * Something in the hand. `carry`: it follows the hand, or turns to it; `line`: what puts it there; null: it waits for the release.
 * @typedef {object} Held
 * @property {(at: Point, turns: boolean) => void} carry
 * @property {() => string | null} line
 * @property {(sketch: import('./sketch.js').Sketch, px: number) => void} draw
 * @property {Point | null} goal Where the goal is put.
 */

/** @param {number[]} numbers */
const written = (...numbers) => numbers.map((each) => each.toFixed(4)).join(' ');

/**
 * What the hand takes at a place; null: nothing is there.
 * @param {Store} store
 * @param {Scene | null} scene Null: it can do nothing in the world.
 * @param {Point | null} goal That of the robot, which may be carried in any world.
 * @param {Point} at
 * @param {number} reach_m
 * @returns {Held | null}
 */
export function take(store, scene, goal, at, reach_m) {
  // With several robots things stay: each has a log of its own.
  const alone = scene && (scene.others ?? []).length === 0;
  return (scene && takeRobot(store, scene, at)) ?? (goal && takeGoal(goal, at, reach_m)) ?? (alone ? takeThing(store, scene, at, reach_m) : null);
}

/** @param {Store} store @param {Scene} scene @param {Point} at @returns {Held | null} */
function takeRobot({ latest }, { footprint_m }, at) {
  if (!latest?.truth) return null;
  let held = latest.truth;
  const by = place(inverse(held), at);
  if (Math.hypot(...by) >= Math.max(...footprint_m.map(([x, y]) => Math.hypot(x, y)), 0)) return null;
  return {
    goal: null,
    carry([x_m, y_m], turns) {
      const { cos, sin } = { cos: Math.cos(held.heading_rad), sin: Math.sin(held.heading_rad) };
      held = turns ? { ...held, heading_rad: Math.atan2(y_m - held.y_m, x_m - held.x_m) } : { ...held, x_m: x_m - cos * by[0] + sin * by[1], y_m: y_m - sin * by[0] - cos * by[1] };
    },
    line: () => `robot=${written(held.x_m, held.y_m, held.heading_rad)}`,
    draw: (sketch, px) => sketch.drawRobot(held, px, 'ghost', false),
  };
}

/** @param {Store} store @param {Scene} scene @param {Point} at @param {number} reach_m @returns {Held | null} */
function takeThing({ latest, readings }, scene, at, reach_m) {
  const t_s = latest?.t_s ?? 0;
  const number = inWorld(scene, readings, t_s).findLastIndex(({ corners_m, closed }) => isAt(corners_m, closed, at, reach_m));
  if (number < 0) return null;
  const was = readings.placeOf(`thing${number}`, t_s) ?? IDENTITY;
  let [dx_m, dy_m] = [0, 0];
  return {
    goal: null,
    carry([x_m, y_m]) {
      [dx_m, dy_m] = [x_m - at[0], y_m - at[1]];
    },
    line: () => `thing=${number} ${written(was.x_m + dx_m, was.y_m + dy_m)}`,
    draw(sketch, px) {
      const shape = inWorld(scene, { placeOf: () => ({ ...was, x_m: was.x_m + dx_m, y_m: was.y_m + dy_m }) }, t_s)[number];
      if (shape) sketch.drawOutlines(px, [shape], colours.goal);
    },
  };
}

/** @param {Point} goal @param {Point} at @param {number} reach_m @returns {Held | null} */
function takeGoal(goal, at, reach_m) {
  if (Math.hypot(goal[0] - at[0], goal[1] - at[1]) > reach_m) return null;
  return {
    goal,
    carry(to) {
      this.goal = to;
    },
    line: () => null,
    draw(sketch, px) {
      if (this.goal) sketch.drawGoal(this.goal, this.goal, px);
    },
  };
}
