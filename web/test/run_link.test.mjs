// @ts-check
/** Links to a run. No browser is needed. */
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { readLink, unpack, writeLink, wrongNumber } from '../src/run_link.js';

test('a link is read as it was written, and the sensor layout is that of the choice', () => {
  const choice = { scenario: 'mode1', world: 'room', rig: null, seed: 7 };
  const link = writeLink('http://localhost/rumbo/#old', { ...choice, robot: undefined, parameters: { rig: 0, front_kp: 4.5 } }, '0.2.0');
  assert.ok(link.startsWith('http://localhost/rumbo/#'), link);
  assert.deepEqual(readLink(new URL(link).hash), { start: { scenario: 'mode1', world: 'room', seed: 7, parameters: { front_kp: 4.5 } }, version: '0.2.0' });
});

test('what was done by hand stays readable in a link', () => {
  const start = { scenario: 'free', seed: 1, parameters: {}, drive: '0.5 arm*1.25 goal -1 0.5', until_s: 3.105, hash: '00ff' };
  const link = writeLink('http://localhost/', start, '0.2.0');
  assert.ok(link.includes('drive=0.5+arm*1.25+goal+-1+0.5&until_s=3.105'), link);
  assert.deepEqual(readLink(new URL(link).hash).start, start);
});

test('an address without a link asks for nothing', () => {
  assert.deepEqual(readLink(''), { start: { parameters: {} }, version: null });
});

test('what is wrong with a link that was written by hand or cut is said in words', async () => {
  const wrong = (/** @type {string} */ link) => wrongNumber(readLink(link).start);
  assert.equal(wrong('#scenario=mode1&front_kp=5.5&seed=7&robots=2&until_s=3.1'), null);
  assert.equal(wrong('#front_kp=5,5'), 'front_kp is no number; write it with a decimal point');
  assert.equal(wrong('#seed=x'), 'seed is no number; write it with a decimal point');
  assert.equal(wrong('#seed=-1'), 'seed is no whole number from 0 on');
  assert.equal(wrong('#seed=1e30'), 'seed is no whole number from 0 on');
  assert.equal(wrong('#robots=1.5'), 'robots is no whole number from 0 on');
  for (const cut of ['garbage', '§', 'AAAA']) await assert.rejects(unpack(cut), { message: 'a file in it is damaged; copy the whole link' });
});
