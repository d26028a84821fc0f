// @ts-check
/** A log in the dashboard, in a real browser: RUMBO_BIN is the program, CHROMIUM the browser (default /usr/bin/chromium). */
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { mkdtempSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { createInterface } from 'node:readline';
import { after, before, test } from 'node:test';
import { chromium } from 'playwright-core';

const BROWSER_ARGS = ['--headless', '--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking'];
/** Long enough for any machine; nothing is judged by it [ms]. */
const PATIENCE_MS = 30_000;

/** @type {import('node:child_process').ChildProcess} */
let replay;
/** @type {import('playwright-core').Browser} */
let browser;
/** @type {import('playwright-core').Page} */
let page;
/** @type {string[]} */
const complaints = [];

before(async () => {
  const program = process.env['RUMBO_BIN'];
  assert.ok(program, 'RUMBO_BIN names the program to test');
  const folder = mkdtempSync(join(tmpdir(), 'rumbo-'));
  spawnSync(program, ['run', 'mode1', '--seed', '3', '--out', folder]);
  replay = spawn(program, ['replay', join(folder, 'mode1-3.mcap'), '--no-browser', '--port', '0', '--speed', '0'], { stdio: ['ignore', 'pipe', 'inherit'] });
  assert.ok(replay.stdout);
  let url = '';
  for await (const line of createInterface({ input: replay.stdout })) {
    url = line;
    break;
  }
  browser = await chromium.launch({ executablePath: process.env['CHROMIUM'] ?? '/usr/bin/chromium', args: BROWSER_ARGS });
  page = await browser.newPage({ viewport: { width: 1280, height: 720 }, colorScheme: 'dark' });
  page.setDefaultTimeout(PATIENCE_MS);
  page.on('pageerror', (error) => complaints.push(String(error)));
  page.on('console', (message) => {
    if (message.type() === 'error') complaints.push(message.text());
  });
  await page.goto(url);
});

after(async () => {
  await browser?.close();
  replay?.kill();
});

/** The time of the last range plotted [s]. */
const plotted_s = () => page.evaluate(() => /** @type {number} */ (/** @type {any} */ (window).rumbo.series('range_front_cm').t.at(-1) ?? -1));
const shown_s = () => page.evaluate(() => /** @type {number} */ (/** @type {any} */ (window).rumbo.state()?.t_s ?? -1));

/** @param {number} t_s */
async function scrub(t_s) {
  await page.locator('#replay-scrub').evaluate((input, value) => {
    /** @type {HTMLInputElement} */ (input).value = String(value);
    input.dispatchEvent(new Event('input'));
    input.dispatchEvent(new Event('change'));
  }, t_s);
  await page.waitForFunction((t) => Math.abs((/** @type {any} */ (window).rumbo.state()?.t_s ?? -1) - t) < 0.01, t_s);
}

test('a log opens paused, and nothing can be sent to a robot', async () => {
  await page.locator('#replay').waitFor();
  assert.equal(await page.locator('#replay-name').textContent(), 'mode1-3');
  assert.match(await page.locator('#replay-time').textContent() ?? '', /of 8\.9 s/);
  assert.equal(await page.locator('#stop').isVisible(), false);
  assert.equal(await page.locator('#command-section').evaluate((section) => /** @type {HTMLElement} */ (section).inert), true);
});

test('scrubbing shows what was before that time, forwards and backwards', async () => {
  await scrub(5);
  await page.waitForFunction(() => {
    const t = /** @type {any} */ (window).rumbo.series('range_front_cm').t.at(-1);
    return t > 4.9 && t <= 5;
  });
  await scrub(2);
  await page.waitForFunction(() => {
    const t = /** @type {any} */ (window).rumbo.series('range_front_cm').t.at(-1);
    return t > 1.9 && t <= 2;
  });
});

test('a step is one telemetry frame', async () => {
  await scrub(2);
  const before_s = await plotted_s();
  await page.locator('#replay-on').click();
  await page.waitForFunction((before) => /** @type {any} */ (window).rumbo.series('range_front_cm').t.at(-1) > before, before_s);
  assert.ok(Math.abs((await plotted_s()) - before_s - 0.04) < 1e-6);
  await page.keyboard.press(',');
  await page.waitForFunction((before) => /** @type {any} */ (window).rumbo.series('range_front_cm').t.at(-1) <= before, before_s);
});

test('it plays, and pauses at its end', async () => {
  await scrub(8.5);
  await page.locator('#replay-play').click();
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state().t_s > 8.9 && /** @type {any} */ (window).rumbo.state().speed === 0);
  assert.equal(await page.locator('#replay-play').textContent(), 'Play');
});

test('a click on an event goes to its time', async () => {
  const line = page.locator('#events li', { hasText: 'sent: reference 50.0 cm' });
  await line.click();
  await page.waitForFunction(() => Math.abs(/** @type {any} */ (window).rumbo.state().t_s - 5.5) < 0.1);
  assert.ok(Math.abs((await shown_s()) - 5.5) < 0.1);
});

test('no script failed on the way', () => {
  assert.deepEqual(complaints, []);
});
