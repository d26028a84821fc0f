// @ts-check
/** Signals computed from others. No browser is needed. */
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { BadExpression, Computed, unitOfExpression } from '../src/computed.js';
import { Table } from '../src/table.js';

const UNITS = /** @type {Record<string, import('../src/signals.js').Unit>} */ ({ left_rpm: 'rpm', right_rpm: 'rpm', x_m: 'm', range_front_cm: 'cm', 'serial0:v': 'printed' });
const unit = (/** @type {string} */ text) => unitOfExpression(`=${text}`, (name) => UNITS[name] ?? null);

test('an expression has the unit of what it adds up, and one that makes no sense says why', () => {
  for (const [text, expected] of [
    ['left_rpm - right_rpm', 'rpm'], ['2 * abs(left_rpm)', 'rpm'], ['derivative(x_m)', 'm/s'], ['derivative(derivative(x_m))', 'm/s²'], ['filter(range_front_cm, 0.5)', 'cm'],
    ['left_rpm / right_rpm', 'printed'], ['serial0:v + 1', 'printed'],
  ]) assert.equal(unit(text ?? ''), expected, text);
  for (const text of ['left_rpm - x_m', 'left_rpmm', 'left_rpm -', 'left_rpm right_rpm', '(left_rpm', '2 + 2', 'left_rpm % 2', '', 'min left_rpm']) assert.throws(() => unit(text), BadExpression, text);
});

test('a difference, a derivative and a filter follow their signals as lines come, and a gap stays one', () => {
  const table = new Table(['a', 'b'], 600);
  const all = new Computed(() => table, 600);
  const column = (/** @type {string} */ name) => all.tableOf(name).columns.get(name);
  for (const [t_s, a, b] of /** @type {[number, number, number | null][]} */ ([[0, 1, 1], [0.5, 3, 1]])) table.push(t_s, { a, b });
  assert.deepEqual(column('=a - b'), [0, 2]);
  for (const [t_s, a, b] of /** @type {[number, number, number | null][]} */ ([[1, 3, null], [1.5, 5, 1]])) table.push(t_s, { a, b });
  assert.deepEqual(column('=derivative(a)'), [null, 4, 0, 4]);
  assert.deepEqual(column('=filter(a, 0.5)'), [1, 2, 2.5, 3.75]);
  assert.deepEqual(column('=a - b')?.at(-1), 4);
});
