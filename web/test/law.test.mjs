// @ts-check
/** Equations of control laws. No browser is needed. */
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { parse, work } from '../src/law.js';

const of = (/** @type {string} */ text, /** @type {Record<string, number>} */ values = {}) => work(parse(text), (name) => values[name] ?? NaN);

test('an equation is worked out as it is written, from left to right and products first', () => {
  for (const [text, value] of /** @type {const} */ ([['2 + 3 * 4', 14], ['8 - 3 - 2', 3], ['8 / 4 / 2', 1], ['-(2 - 5)', 3], ['clamp(7, -2, 2)', 2], ['sign(-4) * max(0.03, min(1, sqrt(0.25)))', -0.5]])) assert.equal(of(text), value, text);
});

test('the term that decides is known, and a limit that is reached', () => {
  const law = parse('clamp(min(cruise, sqrt(2 * brake * off), kp * off), -1, 0.4)');
  const decides = (/** @type {Record<string, number>} */ values) => {
    const all = new Map();
    const given = work(law, (name) => values[name] ?? NaN, all);
    return [given, all.get(law).decides, all.get(law.parts[0]).decides];
  };
  assert.deepEqual(decides({ cruise: 0.5, brake: 0.36, off: 0.7, kp: 5 }), [0.4, 2, 0]);
  assert.deepEqual(decides({ cruise: 0.5, brake: 0.36, off: 0.01, kp: 5 }).slice(1), [0, 2]);
  assert.deepEqual(decides({ cruise: 0.5, brake: 0.36, off: 0.1, kp: 5 }).slice(1), [0, 1]);
});

test('an equation of what is not known has no value and no term that decides', () => {
  const [law, all] = [parse('min(a, b)'), new Map()];
  assert.ok(Number.isNaN(work(law, (name) => (name === 'a' ? 1 : NaN), all)));
  assert.equal(all.get(law).decides, -1);
  assert.throws(() => parse('min(a, b'), /is missing/);
});
