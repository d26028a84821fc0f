// @ts-check
/** A log in the dashboard. */
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { eventually, folder, open, program, rare } from '../dashboard.mjs';

/** @type {Awaited<ReturnType<typeof open>>} */
let dashboard;
/** @type {import('playwright-core').Page} */
let page;

before(async () => {
  const out = folder();
  spawnSync(program(), ['run', 'mode1', '--seed', '3', '--param', 'link_timeout_s=0.4', '--out', out]);
  dashboard = await open(['replay', join(out, 'mode1-3.mcap'), '--speed', '0']);
  page = dashboard.page;
});

after(() => dashboard?.close());

/** The time of what the map shows [s]. */
const mapped_s = () => page.evaluate(() => /** @type {number} */ (/** @type {any} */ (window).rumbo.shown()?.t_s ?? -1));
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
  await eventually(async () => assert.equal(await page.locator('#replay-name').textContent(), 'mode1-3'));
  await eventually(async () => assert.match(await page.locator('#replay-time').textContent() ?? '', /of 8\.9\d s/));
  assert.equal(await page.locator('#stop').isVisible(), false);
  assert.equal(await page.locator('#command-section').evaluate((section) => /** @type {HTMLElement} */ (section).inert), true);
});

test('the parameters have the values that the run had', async () => {
  const input = page.locator('#parameter-link_timeout_s');
  await page.waitForFunction(() => /** @type {HTMLInputElement | null} */ (document.querySelector('#parameter-link_timeout_s'))?.value !== '');
  assert.equal(await input.inputValue(), '0.4');
});

test('scrubbing shows what was at that time, forwards and backwards', async () => {
  await scrub(5);
  await page.waitForFunction(() => {
    const t = /** @type {any} */ (window).rumbo.shown()?.t_s;
    return t > 4.9 && t <= 5;
  });
  await page.locator('#state', { hasText: 'hold' }).waitFor();
  await scrub(2);
  await page.waitForFunction(() => {
    const t = /** @type {any} */ (window).rumbo.shown()?.t_s;
    return t > 1.9 && t <= 2;
  });
  // The numbers beside the curves are those of that time.
  const at_2 = await page.evaluate(() => {
    const { t, y } = /** @type {any} */ (window).rumbo.series('range_front_cm');
    return y[t.findLastIndex((/** @type {number} */ each) => each <= 2)].toFixed(1);
  });
  await page.locator('.plot-curves .curve.measured output', { hasText: at_2 }).first().waitFor();
});

rare('the plots show the whole log, before and after the playhead', async () => {
  await scrub(2);
  await page.waitForFunction(() => {
    const { series, plots } = /** @type {any} */ (window).rumbo;
    const [from_s, to_s] = plots().range_s;
    return series('range_front_cm').t.at(-1) > 8.8 && from_s < 0.01 && to_s > 8.8;
  });
  await page.locator('#window').selectOption('10');
  await page.locator('#window').selectOption('whole');
  assert.equal(await page.locator('#pause').isVisible(), false, 'there is one Pause');
});

test('a step is one telemetry frame', async () => {
  await scrub(2);
  const before_s = await mapped_s();
  await page.locator('#replay-on').click();
  await page.waitForFunction((before) => /** @type {any} */ (window).rumbo.shown().t_s > before, before_s);
  assert.ok(Math.abs((await mapped_s()) - before_s - 0.04) < 1e-6);
  await page.keyboard.press(',');
  await page.waitForFunction((before) => /** @type {any} */ (window).rumbo.shown().t_s <= before, before_s);
});

test('it plays at the speed asked for', async () => {
  await scrub(1);
  await page.locator('#replay-speed').selectOption('4');
  await page.keyboard.press('k');
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state().speed === 4);
  await page.locator('#connection', { hasText: 'replay × 4' }).waitFor();
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state().t_s > 3);
  await page.locator('#replay-play').click();
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state().speed === 0);
  await page.locator('#replay-speed').selectOption('1');
});

rare('it plays, and pauses at its end', async () => {
  await scrub(8.5);
  await page.locator('#replay-play').click();
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state().t_s > 8.9 && /** @type {any} */ (window).rumbo.state().speed === 0);
  await eventually(async () => assert.equal(await page.locator('#replay-play').textContent(), 'Play'));
});

test('a click on an event goes to its time', async () => {
  const line = page.locator('#events li', { hasText: 'sent: setpoint 50.0 cm' });
  await line.click();
  await page.waitForFunction(() => Math.abs(/** @type {any} */ (window).rumbo.state().t_s - 5.5) < 0.1);
  assert.ok(Math.abs((await shown_s()) - 5.5) < 0.1);
});

rare('Enter on an event goes to its time too', async () => {
  await scrub(2);
  await page.locator('#events li', { hasText: 'sent: setpoint 50.0 cm' }).focus();
  await page.keyboard.press('Enter');
  await page.waitForFunction(() => Math.abs(/** @type {any} */ (window).rumbo.state().t_s - 5.5) < 0.1);
});

rare('what is plotted does not jump where the robot moves its origin to its goal', async () => {
  const out = folder();
  spawnSync(program(), ['run', 'mode8-obstacles', '--seed', '1', '--out', out]);
  const other = await open(['replay', join(out, 'mode8-obstacles-1.mcap'), '--speed', '16']);
  try {
    await other.page.waitForFunction(() => /** @type {any} */ (window).rumbo.state()?.speed === 0);
    await other.page.waitForFunction(() => /** @type {any} */ (window).rumbo.shown()?.origin.x_m > 2);
    for (const [name, most] of /** @type {[string, number][]} */ ([['true_x_m', 0.1], ['x_m', 0.1], ['y_m', 0.1], ['true_heading_deg', 20], ['heading_deg', 20]])) {
      const jump = await other.page.evaluate((name) => {
        const y = /** @type {any} */ (window).rumbo.series(name).y.filter((/** @type {unknown} */ each) => typeof each === 'number');
        return Math.max(...y.slice(1).map((/** @type {number} */ each, /** @type {number} */ index) => Math.abs(each - y[index])));
      }, name);
      assert.ok(jump < most, `${name} jumps by ${jump}`);
    }
  } finally {
    await other.close();
  }
});

test('what the plots show is explained', async () => {
  await page.locator('#explain').click();
  await page.locator('#why', { hasText: /^from [\d.]+ to [\d.]+ s/ }).waitFor();
});

test('no script failed on the way', () => {
  assert.deepEqual(dashboard.complaints, []);
});

test('the map is saved as a video of what the plots show', async () => {
  await page.locator('#replay-speed').selectOption('8');
  const [video] = await Promise.all([page.waitForEvent('download'), page.locator('#replay-video').click()]);
  assert.match(video.suggestedFilename(), /^mode1-3-0\.0-\d\.\d\.webm$/);
  const content = readFileSync(await video.path());
  assert.equal(content.readUInt32BE(0), 0x1a45dfa3, 'it is WebM');
  assert.ok(content.length > 5_000, String(content.length));
  await page.locator('#replay-video', { hasText: 'Video' }).waitFor();
});
