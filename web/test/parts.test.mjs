// @ts-check
/** What the page says of lights, sensors and displays. */
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { bitsOf, contentsOf, spoken } from '../src/displays.js';
import { shownOf } from '../src/light.js';
import { sensed } from '../src/sensed.js';

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

test('an inertial sensor shows its accelerations and its turn rate, and nothing while it sleeps', () => {
  /** @type {import('../src/types.js').Part} */
  const imu = { name: 'imu', kind: 'mpu6050', percent: 0, address: 0x68 };
  /** @param {Record<string, number>} values */
  const now = (values) => (/** @type {string} */ signal) => values[signal] ?? null;
  const moving = { imu_forward_m_s2: 0.5, imu_left_m_s2: -1, imu_up_m_s2: 9.81, imu_yaw_deg_s: 90 };
  assert.deepEqual(shownOf(imu, now(moving)), ['0.50 -1.00 9.81 m/s², 90.0 °/s', 0]);
  assert.deepEqual(shownOf(imu, now({ imu_forward_m_s2: NaN })), ['– – – m/s², – °/s', 0]);
});

test('a sensor of distance and a compass show what they measure, and a dash where that is nothing', () => {
  /** @type {import('../src/types.js').Part} */
  const tof = { name: 'tof', kind: 'vl53l0x', percent: 0, address: 0x29 };
  /** @type {import('../src/types.js').Part} */
  const compass = { name: 'north', kind: 'hmc5883l', percent: 0, address: 0x1e };
  assert.deepEqual(shownOf(tof, (signal) => (signal === 'tof_range_cm' ? 41.26 : null)), ['41.3 cm', 0]);
  assert.deepEqual(shownOf(tof, () => Infinity), ['– cm', 0]);
  assert.deepEqual(shownOf(compass, (signal) => (signal === 'north_azimuth_deg' ? 271.4 : null)), ['271°', 0]);
});

test('what the sensors of a robot file give can be plotted, by their names there', () => {
  const signals = ['line_far_left', 'obstacle_back_cm', 'maxsonar_front_cm', 'tof_range_cm', 'light_left_lux', 'north_azimuth_deg', 'imu_yaw_deg_s', 'horn_hz'];
  assert.deepEqual(signals.map((name) => sensed(name)?.[0]), ['far left', 'back', 'front', 'tof', 'left', 'north', 'imu yaw', 'horn']);
  assert.deepEqual(signals.map((name) => sensed(name)?.[2]), ['level', 'cm', 'cm', 'cm', 'lx', '°', '°/s', 'Hz']);
  assert.equal(sensed('rang_front_cm'), null);
});

test('what displays show is told by name, with dots and with letters of the program', () => {
  const contents = contentsOf('screen={"columns":8,"dots":"80ff"}\ntext={"rows":["\\ue001=4\\u00b0 "],"drawn":{},"light":true}\n');
  const screen = /** @type {import('../src/displays.js').Dots} */ (contents.get('screen'));
  assert.deepEqual(bitsOf(screen.dots).map(Number).join(''), '1000000011111111');
  const text = /** @type {import('../src/displays.js').Letters} */ (contents.get('text'));
  assert.deepEqual(text.rows.map(spoken), ['▯=4°']);
});
