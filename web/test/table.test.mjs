// @ts-check
/** Signals in tables. No browser is needed. */
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Table } from '../src/table.js';

test('a legend shows the last value up to the time, however the curve is thinned', () => {
  const table = new Table(['a', 'b'], 600);
  for (let line = 0; line < 6_000; line++) table.push(line / 25, { a: line, b: line % 3 === 0 ? line : undefined });
  assert.deepEqual([42.01, 42, Infinity, -1].map((t_s) => table.at('a', t_s)), [1050, 1050, 5_999, undefined]);
  assert.equal(table.at('b', 42.05), 1050);
  assert.deepEqual([42, 42.01].map((t_s) => table.indexAt(t_s)), [1050, 1051]);
});

test('a signal is known once it has had a value, also to a copy, until all is cleared', () => {
  const table = new Table(['a', 'b'], 600);
  for (let line = 0; line < 3; line++) table.push(line, { a: line === 1 ? 5 : null, b: null });
  const known = (/** @type {Table} */ of) => ['a', 'b', 'c'].map((name) => of.knowsIn(name, -Infinity));
  const copy = table.copy();
  table.clear();
  assert.deepEqual([known(copy), known(table)], [[true, false, false], [false, false, false]]);
  assert.deepEqual([[0, 0], [0, 2], [0.2, 0.5], [1, 1], [1.5, 2], [2, 9]].map(([from = 0, to]) => copy.knowsIn('a', from, to)), [false, true, false, true, false, false]);
});
