// @ts-check
/** Where the page draws what moves. No browser is needed. */
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { poseOf } from '../src/movers.js';

/** @param {number} t_s @param {number} x_m @param {number} y_m */
const waypoint = (t_s, x_m, y_m) => ({ t_s, at: { x_m, y_m, heading_rad: 0 } });
/** @param {'once' | 'loop' | 'back_and_forth'} repeat @param {ReturnType<typeof waypoint>[]} waypoints */
const mover = (repeat, ...waypoints) => ({ corners_m: [], waypoints, repeat, start_s: 1 });
/** @param {ReturnType<typeof mover>} of @param {number} t_s */
const at = (of, t_s) => {
  const { x_m, y_m } = poseOf(of, t_s);
  return [x_m, y_m];
};

// The figures are those of crates/plant/tests/moving.rs.
test('a route is gone once, around, or back and forth', () => {
  const there = [waypoint(0, 0, 0), waypoint(2, 2, 0), waypoint(3, 2, 3)];
  const once = mover('once', ...there);
  assert.deepEqual(at(once, 0.5), [0, 0], 'not yet');
  assert.deepEqual(at(once, 2), [1, 0]);
  assert.deepEqual(at(once, 3.5), [2, 1.5]);
  assert.deepEqual(at(once, 9), [2, 3], 'it stays');
  const back = mover('back_and_forth', ...there);
  assert.deepEqual(at(back, 4), [2, 3], 'where it turns');
  assert.deepEqual(at(back, 4.5), [2, 1.5]);
  assert.deepEqual(at(back, 6), [1, 0]);
  assert.deepEqual(at(back, 8), [1, 0]);
  const loop = mover('loop', waypoint(0, 0, 0), waypoint(2, 2, 0), waypoint(4, 0, 0));
  assert.deepEqual(at(loop, 4), [1, 0]);
  assert.deepEqual(at(loop, 6), [1, 0]);
});
