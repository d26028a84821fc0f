// @ts-check
/** Links to a run. No browser is needed. */
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { readLink, writeLink } from '../src/run_link.js';

test('a link is read as it was written, and the sensor layout is that of the choice', () => {
  const choice = { scenario: 'mode1', world: 'room', rig: null, seed: 7 };
  const link = writeLink('http://localhost/rumbo/#old', choice, undefined, { rig: 0, front_kp: 4.5 }, '0.2.0');
  assert.ok(link.startsWith('http://localhost/rumbo/#'), link);
  assert.deepEqual(readLink(new URL(link).hash), { start: { scenario: 'mode1', world: 'room', seed: 7, parameters: { front_kp: 4.5 } }, version: '0.2.0' });
});

test('an address without a link asks for nothing', () => {
  assert.deepEqual(readLink(''), { start: { parameters: {} }, version: null });
});
