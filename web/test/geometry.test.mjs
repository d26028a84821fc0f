// @ts-check
/** The page's geometry. No browser is needed. */
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { likelyArea } from '../src/geometry.js';
import { bodyOf } from '../src/mounts.js';

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

/** What the control core declares of its parameters: names and defaults. @returns {import('../src/types.js').Parameter[]} */
function declared() {
  const source = readFileSync(new URL('../../crates/control/src/params.rs', import.meta.url), 'utf8');
  return [...source.matchAll(/^ {4}\w+ = "(\w+)", "[^"]*", ([-\d.]+),/gm)]
    .map((found, id) => /** @type {any} */ ({ id, name: found[1], default: Number(found[2]), value: null }));
}

/** Where the robot's file says that the sonars of a rig sit. @param {string} rig */
function inFile(rig) {
  const file = readFileSync(new URL('../../robots/memoria.toml', import.meta.url), 'utf8');
  const part = file.match(new RegExp(`\\[rig\\.${rig}(?:\\.(\\w+))?\\]\\n([^\\[#]*)`)) ?? assert.fail(rig);
  const lines = part[1] ? [`${part[1]} = { ${part[2]?.trim()} }`] : (part[2] ?? '').trim().split('\n');
  return lines.map((line) => {
    const value = (/** @type {string} */ name) => Number(line.match(new RegExp(`${name} = ([-\\d.]+)`))?.[1] ?? 0);
    return { id: ['left', 'right', 'front'].indexOf(line.split(' ')[0] ?? ''), x_m: value('x_m'), y_m: value('y_m'), angle_deg: value('angle_deg'), on_servo: line.includes('on_servo = true') };
  }).sort((a, b) => a.id - b.id);
}

test('a robot that is not simulated has its sonars where its parameters say: as the robot\'s file has them', () => {
  for (const rig of ['front_single', 'front_pair', 'side_pair_left', 'side_pair_right', 'final']) {
    const { sonars, base_m } = bodyOf(rig, declared()) ?? assert.fail(rig);
    const mounts = inFile(rig);
    assert.deepEqual(sonars.map(({ id, on_servo }) => [id, on_servo]), mounts.map(({ id, on_servo }) => [id, on_servo]), rig);
    sonars.forEach(({ at, half_angle_rad }, index) => {
      const { x_m = 0, y_m = 0, angle_deg = 0 } = mounts[index] ?? {};
      near(at.x_m, x_m);
      near(at.y_m, y_m);
      near(at.heading_rad, angle_deg * Math.PI / 180);
      near(half_angle_rad, 0.31);
    });
    near(base_m, 0.1);
  }
});
