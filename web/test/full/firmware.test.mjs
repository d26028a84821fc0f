// @ts-check
/**
 * The dashboard with an image on the emulated Mega: its consoles, a line typed, the buttons in words of the original. SKETCHES is the
 * folder of built sketches; without them there is nothing to test.
 */
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { existsSync, readdirSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { eventually, folder, open, program } from '../dashboard.mjs';

const image = join(process.env['SKETCHES'] ?? '', 'memoria-mode5.elf');
const skip = existsSync(image) ? false : `${image} is missing: run \`cargo xtask sketches\``;
if (skip && process.env['CI']) throw new Error(skip);

/** @type {Awaited<ReturnType<typeof open>>} */
let dashboard;
/** @type {import('playwright-core').Page} */
let page;

before(async () => {
  if (skip) return;
  dashboard = await open(['lab', '--scenario', 'mode5', '--firmware', image, '--out', folder()]);
  page = dashboard.page;
  // Before that nothing hears a click.
  await page.waitForSelector('#connection.good');
});

after(() => dashboard?.close());

test('ON reaches a robot that speaks text, its rows are drawn and stand in the console of its USART', { skip }, async () => {
  await page.locator('#on').click();
  await page.locator('#console').filter({ hasText: /\d+, ?-?\d/ }).waitFor();
  await eventually(async () => assert.equal(await page.locator('#console-choice button[aria-pressed="true"]').textContent(), 'Serial1 (Bluetooth)'));
  await page.waitForFunction(() => {
    const rumbo = /** @type {any} */ (window).rumbo;
    return rumbo.series('left_rpm').y.some((/** @type {number} */ rpm) => rpm > 40);
  });
});

test('a line typed to the console goes out as it is, blanks included', { skip }, async () => {
  await page.locator('#console-text').pressSequentially('REF 90');
  await page.keyboard.press('Enter');
  await page.waitForFunction(() => {
    const rumbo = /** @type {any} */ (window).rumbo;
    return rumbo.series('left_rpm').y.some((/** @type {number} */ rpm) => rpm > 75);
  });
  const picture = process.env['SCREENSHOT_FIRMWARE'];
  if (picture) await page.screenshot({ path: picture });
});

test('STOP goes out as OFF', { skip }, async () => {
  await page.locator('#stop').click();
  await page.waitForFunction(() => {
    const rumbo = /** @type {any} */ (window).rumbo;
    const speeds = rumbo.series('true_left_rpm').y;
    return rumbo.state().robot.armed === false || Math.abs(speeds.at(-1) ?? 99) < 1;
  });
  assert.deepEqual(dashboard.complaints, []);
});

test('a log of it shows what the USART said, as far as the playhead is', { skip }, async () => {
  const out = folder();
  spawnSync(program(), ['run', 'mode5', '--firmware', image, '--seed', '2', '--out', out]);
  const log = readdirSync(out).find((name) => name.endsWith('.mcap')) ?? '';
  const replay = await open(['replay', join(out, log), '--speed', '0']);
  try {
    /** @param {number} t_s */
    const scrub = (t_s) => replay.page.locator('#replay-scrub').evaluate((input, value) => {
      /** @type {HTMLInputElement} */ (input).value = String(value);
      input.dispatchEvent(new Event('change'));
    }, t_s);
    const rows = () => replay.page.locator('#console').textContent().then((text) => (text ?? '').split('\n').length);
    await replay.page.locator('#replay').waitFor();
    assert.equal(await replay.page.locator('#console-section').isVisible(), false, 'nothing was said yet');
    await scrub(3);
    await replay.page.locator('#console').filter({ hasText: /\d+, ?-?\d/ }).waitFor();
    assert.equal(await replay.page.locator('#console-choice button[aria-pressed="true"]').textContent(), 'Serial1');
    assert.equal(await replay.page.locator('#console-line').isVisible(), false, 'nothing is sent to a chip of the past');
    const early = await rows();
    await scrub(5);
    await replay.page.waitForFunction((early) => (document.querySelector('#console')?.textContent ?? '').split('\n').length > early + 10, early);
    await scrub(3);
    await replay.page.waitForFunction((early) => (document.querySelector('#console')?.textContent ?? '').split('\n').length === early, early);
    assert.deepEqual(replay.complaints, []);
  } finally {
    await replay.close();
  }
});
