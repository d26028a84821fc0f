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

test('the robot keeps its distance to a wall that is moved, and a rerun repeats it to the bit', async () => {
  const out = folder();
  const dashboard = await open(['lab', '--scenario', 'mode1', '--out', out, '--speed', '4']);
  const { page } = dashboard;
  try {
    await page.waitForSelector('#connection.good');
    await page.locator('#parameters input').first().waitFor();
    await page.locator('#on').click();
    await page.locator('#end.good').waitFor();
    const x_m = () => page.evaluate(() => /** @type {any} */ (window).rumbo.shown().truth.x_m);
    const was_m = await x_m();
    const wall_m = await page.evaluate(() => Math.max(.../** @type {any} */ (window).rumbo.world().map((/** @type {any} */ each) => each.corners_m[0][0])));
    await drag(page, [wall_m, 0.25], [wall_m - 0.2, 0.25]);
    await eventually(async () => assert.ok(Math.abs(await x_m() - was_m + 0.2) < 0.02, String(await x_m())));
    const moved_m = await page.evaluate(() => Math.max(.../** @type {any} */ (window).rumbo.world().map((/** @type {any} */ each) => each.corners_m[0][0])));
    assert.ok(Math.abs(moved_m - wall_m + 0.2) < 0.02, `${wall_m} ${moved_m}`);
    assert.deepEqual(dashboard.complaints, []);
  } finally {
    await dashboard.close();
  }
  const [log = ''] = readdirSync(out).filter((name) => name.endsWith('.mcap'));
  await eventually(async () => assert.match(execFileSync(program(), ['rerun', join(out, log)], { encoding: 'utf8' }), /: equal/));
});

test('a goal is carried to another place', async () => {
  const dashboard = await open(['lab', '--scenario', 'mode8-goals', '--out', folder()]);
  const { page } = dashboard;
  try {
    await page.waitForSelector('#connection.good');
    const goal = () => page.evaluate(() => /** @type {any} */ (window).rumbo.state().robot.task.goal);
    await eventually(async () => assert.ok(await goal()));
    await page.locator('#goal').waitFor();
    await eventually(async () => assert.ok(await page.evaluate(() => /** @type {any} */ (window).rumbo.shown())));
    const [x_m, y_m] = await goal();
    await drag(page, [x_m, y_m], [x_m - 0.3, y_m + 0.2]);
    await eventually(async () => assert.ok(Math.hypot((await goal())[0] - x_m + 0.3, (await goal())[1] - y_m - 0.2) < 0.03, String(await goal())));
  } finally {
    await dashboard.close();
  }
});
