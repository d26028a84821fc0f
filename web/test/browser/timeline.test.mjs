// @ts-check
/** The time line of a live robot: what was is looked at, and the robot goes on. */
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { eventually, folder, open } from '../dashboard.mjs';

test('dragged back or by a click on an event, the map, the numbers and the state are those of then, the robot goes on, and Live returns', async () => {
  const dashboard = await open(['lab', '--scenario', 'mode1', '--out', folder()]);
  const { page } = dashboard;
  const shown = () => page.evaluate(() => {
    const { t_s, truth, armed } = /** @type {any} */ (window).rumbo.shown();
    return { t_s, x_m: truth.x_m, armed };
  });
  try {
    await page.waitForSelector('#connection.good');
    await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state().t_s > 2);
    await page.locator('#on').click();
    await page.locator('#end', { hasText: 'reached' }).waitFor();
    const end = await shown();
    await page.locator('#timeline').fill('1');
    await page.locator('#timeline-words', { hasText: /^(0\.9|1\.0)\d s/ }).waitFor();
    const then = await shown();
    assert.ok(Math.abs(then.t_s - 1) < 0.05 && !then.armed && Math.abs(then.x_m) < 0.01 && end.x_m > 0.6, JSON.stringify([then, end]));
    assert.equal(await page.locator('#state').textContent(), 'off');
    const front = page.locator('.plot-curves button.measured', { hasText: 'front' }).locator('output').first();
    assert.ok(Number(await front.textContent()) > 100);
    await page.waitForFunction((before) => /** @type {any} */ (window).rumbo.series('left_rpm').t.at(-1) > before + 1, end.t_s);
    assert.equal((await shown()).t_s, then.t_s);
    await page.locator('#live').click();
    await page.locator('#timeline-words', { hasText: 'present' }).waitFor();
    assert.ok((await shown()).x_m > 0.6);
    await page.locator('#events li', { hasText: /armed$/ }).click();
    await page.locator('#timeline-words', { hasText: /^\d+\.\d\d s, .* ago$/ }).waitFor();
    assert.ok(Math.abs((await shown()).x_m) < 0.1);
    await page.locator('#live').click();
    // What was before the simulation began again has no time in it.
    await page.locator('#simulation button[type="submit"]').click();
    await page.locator('#events li', { hasText: 'reset: mode1' }).waitFor();
    await eventually(async () => assert.equal(await page.locator('#events li', { hasText: /armed$/ }).last().getAttribute('data-t'), null));
    assert.deepEqual(dashboard.complaints, []);
  } finally {
    await dashboard.close();
  }
});
