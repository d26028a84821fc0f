// @ts-check
/** What the page says of a light and a buzzer. */
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { shownOf } from '../src/light.js';

test('a light shows its share of the time, a buzzer its tone', () => {
  /** @param {Record<string, number>} values */
  const now = (values) => (/** @type {string} */ signal) => values[signal] ?? null;
  /** @type {import('../src/types.js').Part} */
  const lamp = { name: 'lamp', kind: 'led', percent: 0 };
  /** @type {import('../src/types.js').Part} */
  const horn = { name: 'horn', kind: 'buzzer', percent: 0 };
  assert.deepEqual(shownOf(lamp, now({ pin_lamp_led: 0.25 })), ['25 %', 0.25]);
  assert.deepEqual(shownOf(lamp, now({})), ['0 %', 0]);
  assert.deepEqual(shownOf(horn, now({ horn_hz: 440.2, pin_horn_buzzer: 0.5 })), ['440 Hz', 1]);
  assert.deepEqual(shownOf(horn, now({ horn_hz: 0, pin_horn_buzzer: 1 })), ['100 %', 1]);
});
