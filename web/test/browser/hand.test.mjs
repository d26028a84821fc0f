// @ts-check
/** A hand on the map, while the robot drives. */
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readdirSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { eventually, folder, open, program } from '../dashboard.mjs';

/** @param {import('playwright-core').Page} page @param {[number, number]} from in the world [m] @param {[number, number]} to */
async function drag(page, from, to) {
  const { left, top, places } = await page.evaluate((places) => {
    const { left = 0, top = 0 } = document.getElementById('map')?.getBoundingClientRect() ?? {};
    return { left, top, places: places.map((at) => /** @type {any} */ (window).rumbo.worldOnMap(at)) };
  }, [from, to]);
  const [[x0 = 0, y0 = 0] = [], [x1 = 0, y1 = 0] = []] = places;
  await page.mouse.move(left + x0, top + y0);
  await page.mouse.down();
  await page.mouse.move(left + (x0 + x1) / 2, top + (y0 + y1) / 2, { steps: 3 });
  await page.mouse.move(left + x1, top + y1, { steps: 3 });
  await page.mouse.up();
}

test('the robot and a wall are carried while it drives, a rerun repeats that to the bit, and a goal is carried too', async () => {
  const out = folder();
  const dashboard = await open(['lab', '--scenario', 'mode1', '--out', out]);
  const { page } = dashboard;
  const shown = () => page.evaluate(() => {
    const { truth, estimated } = /** @type {any} */ (window).rumbo.shown();
    return { x_m: truth.x_m, y_m: truth.y_m, believed_m: estimated.x_m };
  });
  const wall_m = () => page.evaluate(() => Math.max(.../** @type {any} */ (window).rumbo.world().map((/** @type {any} */ each) => each.corners_m[0][0])));
  const goal = () => page.evaluate(() => /** @type {any} */ (window).rumbo.state().robot.task.goal);
  try {
    await page.waitForSelector('#connection.good');
    await page.waitForFunction(() => /** @type {any} */ (window).rumbo.shown()?.truth);
    // From then on nothing is laid out anew.
    await page.locator('#reference input').waitFor();
    await page.locator('#parameters input').first().waitFor();
    const before = await shown();
    await drag(page, [before.x_m, before.y_m], [before.x_m + 0.2, before.y_m + 0.1]);
    await eventually(async () => {
      const after = await shown();
      assert.ok(Math.abs(after.x_m - before.x_m - 0.2) < 0.03 && Math.abs(after.y_m - before.y_m - 0.1) < 0.03, JSON.stringify(after));
      assert.ok(Math.abs(after.believed_m - before.believed_m) < 0.001, 'its odometry has not moved');
    });
    await page.locator('#on').click();
    await page.locator('#end', { hasText: 'reached' }).waitFor();
    const [stood_m, stands_m] = [(await shown()).x_m, await wall_m()];
    await drag(page, [stands_m, 0.25], [stands_m - 0.2, 0.25]);
    await eventually(async () => assert.ok(Math.abs((await shown()).x_m - stood_m + 0.2) < 0.02, JSON.stringify(await shown())));
    assert.ok(Math.abs(await wall_m() - stands_m + 0.2) < 0.02);
    await page.locator('#scenario').selectOption('mode8-goals');
    await page.locator('#events li', { hasText: 'reset: mode8-goals' }).waitFor();
    const [carried = ''] = readdirSync(out).filter((name) => name.endsWith('.mcap')).sort();
    assert.match(execFileSync(program(), ['rerun', join(out, carried)], { encoding: 'utf8' }), /: equal, \d{3,} bytes/);
    await page.locator('#goal').waitFor();
    await eventually(async () => assert.ok(await goal()));
    const [x_m, y_m] = await goal();
    await drag(page, [x_m, y_m], [x_m - 0.3, y_m + 0.2]);
    await eventually(async () => assert.ok(Math.hypot((await goal())[0] - x_m + 0.3, (await goal())[1] - y_m - 0.2) < 0.03, String(await goal())));
    assert.deepEqual(dashboard.complaints, []);
  } finally {
    await dashboard.close();
  }
});
