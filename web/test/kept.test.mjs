// @ts-check
/** Runs side by side. No browser is needed. */
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { deserialize, serialize } from 'node:v8';
import { begin_s, differences, on_s, rangeOf, stepsOf } from '../src/kept.js';
import { ROW } from '../src/row.js';

// Its texts are in the browser's language.
Object.assign(globalThis, { navigator: { languages: ['en'] } });
const { Store } = await import('../src/store.js');

const stretch = (/** @type {number} */ from_s, /** @type {boolean} */ armed) => ({ from_s, to_s: from_s + 1, mode: 1, state: 0, armed, faulted: false });
const step = (/** @type {number} */ from_s) => ({ from_s, until_s: from_s + 2, mode: 1, kind: /** @type {const} */ ('distance'), reference: /** @type {[number, number]} */ ([30, 0]), ahead: true });

test('a run counts from the ON that came last, and its steps are those since', () => {
  const run = { stretches: [stretch(0, false), stretch(1, true), stretch(2, true), stretch(5, false), stretch(8, true), stretch(9, true)], steps: [step(1), step(8), step(11)] };
  assert.equal(on_s(run), 8);
  assert.deepEqual(stepsOf(run).map(({ from_s }) => from_s), [8, 11]);
  assert.deepEqual(['', 'on', '0', '1', '2'].map((align) => begin_s(run, align)), [0, 8, 8, 11, 0]);
  assert.equal(on_s({ stretches: [stretch(0, false)] }), null);
});

test('only what is not the same in all runs is shown, also what one of them lacks', () => {
  assert.deepEqual(differences([{ seed: 1, front_kp: 2, sketch: 'wall' }, { seed: 1, front_kp: 3 }]), [['front_kp', [2, 3]], ['sketch', ['wall', undefined]]]);
});

test('the range of many runs has the lowest and the highest at each time, as long as half of them last', () => {
  const lines = [[0, 0], [1, 3], [5, 2], [9, 1]].map(([value = 0, end = 0]) => ({ t: [0, end], y: [value, value] }));
  const { t, low, high, middle } = rangeOf(lines, 1);
  assert.deepEqual([t, low, middle, high], [[0, 1, 2], [0, 1, 1], [5, 5, 5], [9, 9, 5]]);
});

test('a gap in one run is no zero of the range', () => {
  assert.deepEqual(rangeOf([{ t: [0, 1], y: [4, null] }, { t: [0, 1], y: [6, 7] }], 1).low, [4, 7]);
});

test('a kept run is the same after a reload, and ten minutes of one weigh some megabytes', () => {
  const store = new Store();
  const columns = ['t_s', 'mode', 'armed', ...new Set(ROW.flatMap(({ column }) => [column, column.replace('_rad_s', '_before_rad_s')]))];
  store.begin(columns, []);
  for (let line = 0; line < 15_000; line++) store.push([line / 25, 1, 1, ...columns.slice(3).map((_, index) => Math.sin(line + index))]);
  // What IndexedDB does with it, byte for byte.
  const bytes = serialize(store.frozen().content());
  assert.ok(bytes.length > 3e6 && bytes.length < 12e6, String(bytes.length));
  const again = Store.of(deserialize(bytes));
  for (const name of ['left_rpm', 'range_front_cm', 'x_m']) assert.deepEqual(again.series(name), store.series(name));
  assert.deepEqual([again.stretches, on_s(again)], [store.stretches, 0]);
});
