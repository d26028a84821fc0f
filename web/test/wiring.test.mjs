// @ts-check
/** The wiring of one's own robot. No browser is needed. */
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { addable, added, byPin, isSource, pinOf, request, rowsOf, sensorOf } from '../src/wiring.js';

const UNO = { name: 'uno', title: 'Arduino Uno', pins: Array.from({ length: 20 }, (_, pin) => ({ name: pin < 14 ? String(pin) : `A${pin - 14}`, pwm: false })) };
const L298N = { name: 'l298n', title: '', jumpers: false, standby: false, needed: ['left_enable', 'left_forward', 'left_backward', 'right_enable', 'right_forward', 'right_backward'] };
const MX1508 = { ...L298N, name: 'mx1508', needed: ['left_forward', 'left_backward', 'right_forward', 'right_backward'] };
const TB6612 = { ...L298N, name: 'tb6612', standby: true };

test('another driver has other inputs; pins that still have a use stay, and so does all that is no input', () => {
  const rows = [...rowsOf(L298N, []), ...added('servo', []), ...added('led', [])].map((row, index) => ({ ...row, pin: String(index + 2) }));
  assert.deepEqual(rowsOf(MX1508, rows).map(({ signal, pin }) => `${signal}=${pin}`), ['left_forward=3', 'left_backward=4', 'right_forward=6', 'right_backward=7', 'servo=8', 'led_1=9']);
  assert.equal(rowsOf(TB6612, rows).filter(({ signal }) => signal === 'standby').length, 1);
  assert.equal(rowsOf(L298N, rowsOf(TB6612, rows)).some(({ signal }) => signal === 'standby'), false);
});

test('sensors and parts are numbered; what has no pin is not asked', () => {
  const rows = [{ signal: 'left_forward', pin: ' 7 ' }, { signal: 'servo', pin: ' ' }];
  for (const what of ['line', 'line', 'button', 'mpu6050']) rows.push(...added(what, rows));
  assert.deepEqual(rows.slice(2), [{ signal: 'line_1', pin: '' }, { signal: 'line_2', pin: '' }, { signal: 'button_1', kind: 'button', pin: '' }, { signal: 'mpu6050_1', kind: 'mpu6050', pin: '0x68' }]);
  const { plan } = request({ name: 'a', like: null, board: 'uno', driver: 'l298n', said: {} }, rows);
  assert.deepEqual([plan.pins, plan.parts], [[['left_forward', '7']], [['mpu6050_1', 'mpu6050', '0x68']]]);
});

test('a sonar has two wires and a place, usual by its name; another one brings its place', () => {
  const front = added('front_sonar', []);
  assert.deepEqual(front.map(({ signal }) => signal), ['front_trigger', 'front_echo']);
  assert.deepEqual(front.map(sensorOf), ['front', null]);
  const rows = [...front, ...added('other_sonar', front)].map((row, pin) => ({ ...row, pin: String(pin + 2) }));
  const plan = () => request({ name: 'a', like: null, board: 'uno', driver: 'l298n', said: { battery: '7.4' } }, rows).plan;
  assert.deepEqual([plan().places, plan().said], [['sonar_1=0.11:0:0'], { battery: '7.4' }]);
  rows[0] = { ...rows[0], signal: 'front_trigger', pin: '2', place: '0,1:0,02:15' };
  assert.deepEqual(plan().places, ['front=0.1:0.02:15', 'sonar_1=0.11:0:0']);
  assert.equal(addable(rows, { boards: [], drivers: [], known: [], asked: [], parts: [] }).includes('front_sonar'), false);
});

test('a sketch is made of sources, and a project of PlatformIO says how', () => {
  const names = ['car.ino', 'src/main.cpp', 'platformio.ini', 'lib/a/platformio.ini', 'readme.md'];
  assert.deepEqual(names.filter(isSource), ['car.ino', 'src/main.cpp', 'platformio.ini']);
});

test('a pin has a number or a name, and may have several signals', () => {
  assert.deepEqual(['7', 'D07', 'a3', '17', 'A6', 'M1', ''].map((text) => pinOf(UNO, text)), ['7', '7', 'A3', 'A3', null, null, null]);
  const on = byPin(UNO, [{ signal: 'left_trigger', pin: '17' }, { signal: 'left_echo', pin: 'A3' }], { 4: 'line middle', A3: 'left_echo' });
  assert.deepEqual([...on], [['A3', ['left_trigger', 'left_echo']], ['4', ['line middle']]]);
});
