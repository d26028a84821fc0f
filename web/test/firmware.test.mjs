// @ts-check
/**
 * The dashboard with an image on the emulated Mega: its consoles, a line typed, the buttons in words of the original. SKETCHES is the
 * folder of built sketches; without them there is nothing to test.
 */
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { existsSync } from 'node:fs';
import { join } from 'node:path';
import { createInterface } from 'node:readline';
import { after, before, test } from 'node:test';
import { chromium } from 'playwright-core';

/** Long enough for any machine; nothing is judged by it [ms]. */
const PATIENCE_MS = 30_000;
const image = join(process.env['SKETCHES'] ?? '', 'memoria-mode5.elf');
const skip = existsSync(image) ? false : `${image} is missing: run \`cargo xtask sketches\``;
if (skip && process.env['CI']) throw new Error(skip);

/** @type {import('node:child_process').ChildProcess | undefined} */
let lab;
/** @type {import('playwright-core').Browser | undefined} */
let browser;
/** @type {import('playwright-core').Page} */
let page;
/** @type {string[]} */
const complaints = [];

before(async () => {
  if (skip) return;
  const program = process.env['RUMBO_BIN'];
  assert.ok(program, 'RUMBO_BIN names the program to test');
  const options = ['lab', '--no-browser', '--port', '0', '--scenario', 'mode5', '--firmware', image];
  lab = spawn(program, options, { stdio: ['ignore', 'pipe', 'inherit'] });
  assert.ok(lab.stdout);
  let url = '';
  for await (const line of createInterface({ input: lab.stdout })) {
    url = line.match(/http:\/\/\S+/)?.[0] ?? '';
    if (url) break;
  }
  browser = await chromium.launch({ executablePath: process.env['CHROMIUM'] ?? '/usr/bin/chromium', args: ['--headless', '--no-sandbox', '--disable-gpu'] });
  page = await browser.newPage({ viewport: { width: 1280, height: 720 }, colorScheme: 'dark' });
  page.setDefaultTimeout(PATIENCE_MS);
  page.on('pageerror', (error) => complaints.push(String(error)));
  await page.goto(url);
});

after(async () => {
  await browser?.close();
  lab?.kill();
});

test('ON reaches a robot that speaks text, its rows are drawn and stand in the console of its USART', { skip }, async () => {
  await page.locator('#on').click();
  await page.locator('#console').filter({ hasText: /\d+, ?-?\d/ }).waitFor();
  assert.equal(await page.locator('#console-choice button[aria-pressed="true"]').textContent(), 'USART1');
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
  assert.deepEqual(complaints, []);
});
