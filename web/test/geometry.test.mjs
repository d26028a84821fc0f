// @ts-check
/** The page's geometry. */
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { likelyArea } from '../src/geometry.js';

/** @param {number} a @param {number} b */
const near = (a, b) => assert.ok(Math.abs(a - b) < 1e-9, `${a}, expected ${b}`);

test('the likely area of a place is as long as its deviations along its own axes', () => {
  // 3 cm along 30 degrees, 1 cm across it.
  const [along, across, angle] = [0.03, 0.01, Math.PI / 6];
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  const x_m = Math.hypot(along * c, across * s);
  const y_m = Math.hypot(along * s, across * c);
  const correlation = ((along ** 2 - across ** 2) * c * s) / (x_m * y_m);
  const { half_m, direction_rad } = likelyArea({ x_m, y_m, correlation, heading_rad: 0 });
  near(direction_rad, angle);
  near(half_m[0] ?? 0, Math.sqrt(5.991) * along);
  near(half_m[1] ?? 0, Math.sqrt(5.991) * across);
});

test('a place that is known along a line only has a flat area', () => {
  const { half_m } = likelyArea({ x_m: 0.02, y_m: 0.02, correlation: 1, heading_rad: 0 });
  near(half_m[1] ?? 1, 0);
});
