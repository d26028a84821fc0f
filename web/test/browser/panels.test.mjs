// @ts-check
/** What stands beside the events: the state machine of the mode and the link. */
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, test } from 'node:test';
import { eventually, folder, open, rare } from '../dashboard.mjs';

/** @type {Awaited<ReturnType<typeof open>>} */
let dashboard;
/** @type {import('playwright-core').Page} */
let page;

before(async () => {
  dashboard = await open(['lab', '--out', folder()]);
  page = dashboard.page;
  await page.waitForSelector('#connection.good');
});

after(() => dashboard?.close());

test('the states of the mode are drawn, with the live one lit and the way that led there', async () => {
  await page.getByRole('tab', { name: 'States' }).click();
  await eventually(async () => assert.deepEqual(await page.locator('.state-box text').allTextContents(), ['approach', 'settle', 'hold']));
  assert.equal(await page.locator('.state-box.live').count(), 0, 'not armed');
  // What was drawn, as it was drawn: a busy machine asks too late.
  await page.evaluate(() => {
    /** @type {string[][]} */
    const drawn = [];
    const note = () => drawn.push(['.state-box.live', '.way.taken title'].map((each) => document.querySelector(each)?.textContent ?? ''));
    new MutationObserver(note).observe(/** @type {Element} */ (document.querySelector('.state-box')?.closest('svg')?.parentElement), { subtree: true, childList: true, attributes: true });
    Object.assign(window, { drawn });
  });
  await page.locator('#on').click();
  for (const wanted of [['approach', ''], ['settle', 'approach → settle: '], ['hold', 'settle → hold: ']]) {
    await page.waitForFunction(([state, way]) => /** @type {any} */ (window).drawn.some((/** @type {[string, string]} */ [live, taken]) => live.includes(state ?? '') && taken.startsWith(way ?? '')), wanted);
  }
  await page.locator('#stop').click();
  await page.waitForFunction(() => document.querySelectorAll('.state-box.live').length === 0);
});

rare('each mode has its own machine, with every state in a box', async () => {
  const declared = (/** @type {string} */ file) => readFileSync(new URL(`../../../crates/control/src/mode/${file}.rs`, import.meta.url), 'utf8').match(/^ {8}\w+ = "/gm)?.length;
  /** @type {Record<number, number | undefined>} */
  const states = { 0: declared('manual'), 8: declared('mission/mod') };
  for (const mode of [0, 8]) {
    await page.locator(`#modes button[value="${mode}"]`).click();
    await page.waitForFunction((mode) => /** @type {any} */ (window).rumbo.state().robot.mode === mode, mode);
    await page.waitForFunction((count) => document.querySelectorAll('.state-box').length === count, states[mode]);
  }
});

rare('the link shows its rate, its load, what was lost, and its bytes frame by frame', async () => {
  await page.getByRole('tab', { name: 'Causes' }).focus();
  await page.keyboard.press('ArrowRight');
  const figures = page.locator('#link-figures');
  await figures.locator('dd', { hasText: /^2\d(\.\d)? Hz$/ }).waitFor();
  assert.match(await figures.innerText(), /9600 baud/);
  await page.keyboard.press('ArrowRight');
  const bytes = page.locator('#link-bytes');
  await bytes.filter({ hasText: /← telemetry +[0-9a-f]{2} 2/ }).filter({ hasText: /→ heartbeat/ }).waitFor();
  await page.locator('#link-hold').check();
  const held = await bytes.textContent();
  await page.waitForFunction((t) => /** @type {any} */ (window).rumbo.series('left_pwm').t.at(-1) > t + 0.5, await page.evaluate(() => /** @type {any} */ (window).rumbo.series('left_pwm').t.at(-1)));
  assert.equal(await bytes.textContent(), held);
  assert.deepEqual(dashboard.complaints, []);
});

/** A gamepad with these buttons down and its left stick there, in the page. @param {number[]} buttons @param {[number, number]} stick */
function gamepad(buttons, stick) {
  return page.evaluate(({ buttons, stick }) => {
    const pad = { connected: true, axes: [...stick, 0, 0], buttons: Array.from({ length: 17 }, (_none, index) => ({ pressed: buttons.includes(index) })) };
    Object.defineProperty(navigator, 'getGamepads', { configurable: true, value: () => [pad] });
  }, { buttons, stick });
}

/** Waits until the newest value of a signal lies there. @param {string} name @param {number} low @param {number} [high] */
const latest = (name, low, high = low) => page.waitForFunction(({ name, low, high }) => {
  const { y } = /** @type {any} */ (window).rumbo.series(name);
  const last = y.filter((/** @type {unknown} */ each) => typeof each === 'number').at(-1);
  return last >= low && last <= high;
}, { name, low, high });

rare('a gamepad drives while its shoulder button is held, less with the stick half way, and lets go', async () => {
  await page.locator('#modes button[value="0"]').click();
  await page.locator('#modes button[value="0"][aria-pressed="true"]').waitFor();
  await page.locator('#on').click();
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state().robot.armed);
  await gamepad([], [0, -1]);
  // Some telemetry later it still stands.
  const before_s = await page.evaluate(() => /** @type {any} */ (window).rumbo.series('left_pwm').t.at(-1));
  await page.waitForFunction((before_s) => /** @type {any} */ (window).rumbo.series('left_pwm').t.at(-1) > before_s + 0.3, before_s);
  await latest('left_pwm', 0);
  await gamepad([5], [0, -1]);
  await latest('left_pwm', 89);
  await gamepad([5], [0, -0.7]);
  await latest('left_pwm', 67);
  await gamepad([5], [1, 0]);
  await latest('right_pwm', -255, -1);
  await gamepad([], [1, 0]);
  await latest('right_pwm', 0);
  assert.equal(await page.evaluate(() => /** @type {any} */ (window).rumbo.state().robot.armed), true);
});

rare('a gamepad that drives is released when another window gets the focus, and its B is STOP', async () => {
  await gamepad([5], [0, -1]);
  await latest('left_pwm', 89);
  await page.evaluate(() => {
    document.hasFocus = () => false;
    dispatchEvent(new Event('blur'));
  });
  await latest('left_pwm', 0);
  await gamepad([1], [0, 0]);
  await page.waitForFunction(() => !(/** @type {any} */ (window).rumbo.state().robot.armed));
});

test('in mode 10 the pad drives while it is held, as far as it is dragged, by the law that is shown, and the wheels stand when it is let go', async () => {
  await page.getByRole('tab', { name: 'Law' }).click();
  await page.locator('#modes button[value="10"]').click();
  await page.locator('#modes button[value="10"][aria-pressed="true"]').waitFor();
  await page.locator('#on').click();
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state().robot.armed);
  await page.locator('#top-forward').fill('0.2');
  const pad = page.locator('.joystick.live');
  const { x, y, width, height } = await pad.boundingBox() ?? { x: 0, y: 0, width: 0, height: 0 };
  await page.mouse.move(x + width / 2, y + height / 2);
  await page.mouse.down();
  // Half a radius up: half of 0.2 m/s, with wheels of 33 mm.
  await page.mouse.move(x + width / 2, y + height / 4);
  await latest('left_ref_rpm', 26, 32);
  await page.locator('#law .law', { hasText: /^left_ref_rad_s (3\.\d+) = left_asked_rad_s \1 · slower 1 / }).waitFor();
  await page.mouse.move(x + width / 2, y + height / 4 + 1);
  // Longer than the robot drives without a velocity.
  const before_s = await page.evaluate(() => /** @type {any} */ (window).rumbo.series('left_pwm').t.at(-1));
  await page.waitForFunction((before_s) => /** @type {any} */ (window).rumbo.series('left_pwm').t.at(-1) > before_s + 0.8, before_s);
  await latest('left_ref_rpm', 26, 32);
  await page.mouse.up();
  await latest('left_pwm', 0);
  assert.match(await page.locator('#joystick output').innerText(), /^0\.00 m\/s/);
  await page.getByRole('tab', { name: 'Events' }).click();
  await page.locator('#stop').click();
});

test('help opens by key and by button, and closes by Escape', async () => {
  await page.locator('#map').focus();
  await page.keyboard.press('?');
  await page.locator('#help-dialog').getByText('STOP, from anywhere but a line of text', { exact: false }).waitFor();
  await page.keyboard.press('Escape');
  await page.locator('#help-dialog').waitFor({ state: 'hidden' });
  await page.locator('#help').click();
  await page.locator('#help-dialog').waitFor();
  await page.keyboard.press('Escape');
  assert.deepEqual(dashboard.complaints, []);
});
