// @ts-check
/** A robot of one's own is wired on the page, checked as it is typed, and drives with a sketch. */
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, test } from 'node:test';
import { violations } from '../axe.mjs';
import { folder, open } from '../dashboard.mjs';

/** Both wheels forward, by PWM on one of two inputs. */
const SKETCH = `void setup() { Serial.begin(9600); pinMode(5, OUTPUT); pinMode(6, OUTPUT); pinMode(9, OUTPUT); pinMode(10, OUTPUT); }
void loop() { analogWrite(5, 150); digitalWrite(6, LOW); analogWrite(9, 150); digitalWrite(10, LOW); delay(20); }
`;

/** @type {Awaited<ReturnType<typeof open>>} */
let dashboard;
/** @type {import('playwright-core').Page} */
let page;

before(async () => {
  dashboard = await open(['lab', '--scenario', 'mode1', '--out', folder()], { viewport: { width: 1280, height: 800 } });
  page = dashboard.page;
  await page.locator('#wire').click();
  await page.locator('#wire-rows input').first().waitFor();
});

after(() => dashboard?.close());

/** @param {string} signal */
const field = (signal) => page.locator(`#wire-${signal}`);
const problem = () => page.locator('#wire-problem');

test('pins are typed or dragged onto the board, and checked at once', async () => {
  await page.locator('#wire-driver').selectOption('l298n-jumpers');
  await problem().filter({ hasText: 'still without a pin: left, forward input' }).waitFor();
  await field('left_forward').fill('5');
  await field('left_backward').fill('5');
  await field('right_forward').fill('9');
  await field('right_backward').fill('45');
  await problem().filter({ hasText: 'the Arduino Uno has no pin 45' }).waitFor();
  const cell = page.locator('#wire-pins li', { hasText: '~10' });
  await page.locator('label[for="wire-right_backward"]').hover();
  await page.mouse.down();
  // What is dragged is over the cell from the second move on.
  await cell.hover();
  await cell.hover();
  await page.mouse.up();
  await page.waitForFunction(() => /** @type {HTMLInputElement} */ (document.querySelector('#wire-right_backward')).value === '10');
  await field('left_backward').fill('12');
  await page.locator('#wire-remarks', { hasText: 'left_backward = 12: no PWM on that pin' }).waitFor();
  await field('left_backward').fill('6');
  await page.locator('#wire-add').selectOption('button');
  await field('button_1').fill('6');
  await problem().filter({ hasText: 'left_backward is on that pin' }).waitFor();
  assert.equal(await page.locator('#wire-drive').isDisabled(), true);
  await field('button_1').fill('2');
  await page.locator('#wire-pins li', { hasText: 'button 1' }).waitFor();
  assert.deepEqual(await violations(page), []);
});

test('its file is kept, and its sketch drives it', async () => {
  await page.locator('#wire-dialog input[accept]').setInputFiles({ name: 'car.ino', mimeType: 'text/plain', buffer: Buffer.from(SKETCH) });
  await page.locator('#wire-said-motor').selectOption('n20');
  await page.locator('#wire-said-top-speed').fill('9');
  await problem().filter({ hasText: 'top-speed = 9: must be within 0.02..3 m/s' }).waitFor();
  await page.locator('#wire-said-top-speed').fill('0.3');
  await page.locator('#wire-add').selectOption('line');
  await field('line_1').fill('A0');
  await page.locator('input[data-sensor="line_1"]').fill('0.05:0.01');
  await page.locator('#wire-text', { hasText: 'left_forward = 5' }).and(page.locator('#wire-text', { hasText: 'x_m = 0.05, y_m = 0.0100' })).waitFor({ state: 'attached' });
  const saved = page.waitForEvent('download');
  await page.locator('#wire-dialog').getByRole('button', { name: 'Save file' }).click();
  const file = readFileSync(await (await saved).path(), 'utf8');
  assert.match(file, /board = "uno"[^]*left_enable = "high"[^]*left_forward = 5 [^]*parts.button_1 = { button = 2 }[^]*drive 0.3 m\/s at full PWM[^]*N20 gear motors/);
  const picture = process.env['SCREENSHOT_WIRE'];
  if (picture) await page.screenshot({ path: picture });
  const choose = (/** @type {string} */ text) => page.locator('#wire-dialog input[accept]').setInputFiles({ name: 'car.ino', mimeType: 'text/plain', buffer: Buffer.from(text) });
  await choose(SKETCH.replace('LOW', 'low'));
  await page.locator('#wire-drive').click();
  await problem().filter({ hasText: /car\.ino:2:\d+: 'low' was not declared/ }).waitFor();
  await choose(SKETCH);
  await page.locator('#wire-drive').click();
  await page.waitForSelector('body.own');
  await page.locator('#wire-dialog').waitFor({ state: 'hidden' });
  assert.equal(await page.locator('#program-name').textContent(), 'car');
  assert.equal(await page.locator('#world').inputValue(), 'line_loop');
  await page.waitForFunction(() => {
    const last = (/** @type {string} */ name) => /** @type {any} */ (window).rumbo.series(name).y.at(-1);
    return last('true_left_rpm') > 20 && last('true_right_rpm') > 20;
  });
  await page.locator('#parts', { hasText: 'button_1' }).waitFor();
});
