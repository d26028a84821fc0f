// @ts-check
/** The figures of a step. No browser is needed. */
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { response, stage } from '../src/response.js';

/** @param {(t_s: number) => number} signal */
function sampled(signal) {
  const t = Array.from({ length: 400 }, (_, index) => (index + 1) / 100);
  return { t, y: t.map(signal) };
}

/** @param {number} span */
const band = (span) => 0.05 * span;

test('a first-order response settles after three time constants', () => {
  const { settling_s, rise_s, overshoot, steady_error } = response(sampled((t) => 1 - 0.7 * (1 - Math.exp(-t / 0.4))), 0, 0.3, band);
  assert.ok(Math.abs(settling_s - 0.4 * Math.log(20)) < 0.02 && Math.abs(rise_s - 0.4 * Math.log(9)) < 0.02, `${settling_s}, ${rise_s}`);
  assert.ok(overshoot < 1e-9 && steady_error < 0.01);
});

test('overshoot is what goes beyond the setpoint in the direction of the step', () => {
  const { overshoot, steady_error } = response(sampled((t) => (t < 1 ? (t < 0.02 ? 1 : 0.27) : 0.31)), 0, 0.3, band);
  assert.ok(Math.abs(overshoot - 0.03) < 1e-9 && Math.abs(steady_error - 0.01) < 1e-9);
});

test('what never happened has no figure', () => {
  const away = response(sampled(() => 1), 0, 0.3, band);
  assert.ok([away.settling_s, away.rise_s, away.overshoot].every(Number.isNaN));
  const there = response(sampled(() => 0.3), 0, 0.3, () => 0.035);
  assert.ok(Number.isNaN(there.settling_s) && Number.isNaN(there.rise_s));
  const gone = response(sampled((t) => (t < 3.9 ? 0.3 + 0.7 * Math.exp(-9 * t) : 0.5)), 0, 0.3, band);
  assert.ok(Number.isNaN(gone.settling_s));
});

test('a step that goes on has no figures until it has settled for good', () => {
  const running = { from_s: 10, runs: true };
  assert.deepEqual([[NaN, 11], [2, 12.5], [2, 13.2], [2, 15.1]].map(([settling_s = NaN, now_s = NaN]) => stage({ settling_s, moving: 0 }, running, now_s)), ['running', 'running', 'running', 'over']);
});

test('a step that STOP ended on its way was stopped; one that stood or that another followed is over', () => {
  const stopped = { from_s: 10, runs: false, stopped: true };
  assert.equal(stage({ settling_s: NaN, moving: 1 }, stopped, 12), 'stopped');
  assert.equal(stage({ settling_s: NaN, moving: 0 }, stopped, 12), 'over');
  assert.equal(stage({ settling_s: 2, moving: 0 }, stopped, 16), 'over');
  assert.equal(stage({ settling_s: NaN, moving: 1 }, { ...stopped, stopped: false }, 12), 'over');
  // Half way to a wall, away from a setpoint that is never reached, and swinging about it.
  const moving = (/** @type {(t_s: number) => number} */ signal, /** @type {number} */ reference) => response(sampled(signal), 0, reference, () => 0.05).moving;
  assert.deepEqual([moving((t) => 1 - 0.1 * t, 0.3), moving((t) => 1 - Math.exp(-4 * t), 0.7), moving((t) => 1 + 0.5 * Math.sin(40 * t), 1)], [1, 0, 0]);
});
