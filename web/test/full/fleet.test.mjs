// @ts-check
/** Several robots in one world: each has a page, STOP stops all. */
import assert from 'node:assert/strict';
import { readdirSync } from 'node:fs';
import { after, before, test } from 'node:test';
import { eventually, folder, open } from '../dashboard.mjs';

/** @type {Awaited<ReturnType<typeof open>>} */
let dashboard;
/** @type {import('playwright-core').Page} */
let page;
const recordings = folder();

const state = () => page.evaluate(() => /** @type {import('../../src/types.js').State} */ (/** @type {any} */ (window).rumbo.state()));

/** Goes to the page of a robot. @param {string} name */
async function show(name) {
  if (await page.locator('#robot').inputValue() !== name) await Promise.all([page.waitForEvent('websocket'), page.locator('#robot').selectOption(name)]);
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state()?.link.connected);
  assert.equal(await page.locator('#robot').inputValue(), name);
}

/** @param {boolean} armed */
const isArmed = (armed) => eventually(async () => assert.equal((await state()).robot.armed, armed));

before(async () => {
  dashboard = await open(['lab', '--robots', '3', '--scenario', 'mode6', '--out', recordings], { locale: 'es-ES' });
  page = dashboard.page;
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state()?.link.connected);
});

after(() => dashboard?.close());

test('each robot is driven from its own page', async () => {
  await page.evaluate(() => Object.assign(window, { kept: true }));
  assert.deepEqual(await page.locator('#robot option').allTextContents(), ['robot1', 'robot2', 'robot3']);
  await show('robot2');
  assert.equal(await page.locator('#simulation').isVisible(), false, 'the first one has the choice');
  await page.locator('#on').click();
  await isArmed(true);
  await show('robot3');
  assert.equal((await state()).robot.armed, false);
  await page.locator('#on').click();
  await isArmed(true);
  await show('robot1');
  assert.equal((await state()).robot.armed, false);
  assert.equal(await page.locator('#simulation').isVisible(), true);
  assert.equal(await page.evaluate(() => 'kept' in window), true, 'the page has not been loaded again');
  assert.equal(await page.locator('#edit-world').isVisible(), false, 'a world is edited with one robot in it');
});

test('the map shows the others where they drive', async () => {
  const at = () => page.evaluate(() => /** @type {any} */ (window).rumbo.others().map((/** @type {any} */ { name, x_m, y_m }) => ({ name, x_m, y_m })));
  const before = await eventually(async () => {
    const found = await at();
    assert.deepEqual(found.map((/** @type {any} */ { name }) => name), ['robot2', 'robot3']);
    return found;
  });
  await eventually(async () => {
    const now = await at();
    assert.ok(now.every((/** @type {any} */ { x_m, y_m }, /** @type {number} */ index) => Math.hypot(x_m - before[index].x_m, y_m - before[index].y_m) > 0.1));
  });
  if (process.env['SCREENSHOT']) await page.screenshot({ path: process.env['SCREENSHOT'] });
});

test('what the sonars measure stands beside or below the choice of robots', async () => {
  const size = page.viewportSize();
  for (const width of [1440, 1280, 1024, 920]) {
    await page.setViewportSize({ width, height: 800 });
    const box = (/** @type {string} */ name) => page.locator(name).boundingBox();
    await eventually(async () => {
      const [pose, corner] = await Promise.all([box('#pose'), box('#map-corner')]);
      assert.ok(pose && corner && (pose.x + pose.width <= corner.x || pose.y + 2 >= corner.y + corner.height), `${width}: ${JSON.stringify([pose, corner])}`);
    });
  }
  if (size) await page.setViewportSize(size);
});

test('STOP on any page stops all', async () => {
  const { x, width } = await page.locator('#stop').boundingBox() ?? { x: Infinity, width: 0 };
  assert.ok(x + width <= 1280, `STOP ends at ${x + width}`);
  await page.locator('#stop').click();
  for (const name of ['robot2', 'robot3']) {
    await show(name);
    await isArmed(false);
  }
});

test('Reset starts all again, and each has recordings of its own', async () => {
  await show('robot1');
  await page.locator('#seed').fill('7');
  await page.locator('#simulation button[type=submit]').click();
  await eventually(async () => assert.ok((await state()).t_s < 3));
  await show('robot3');
  assert.equal((await state()).robot.armed, false);
  const logs = readdirSync(recordings);
  for (const name of ['robot1', 'robot2', 'robot3']) assert.equal(logs.filter((log) => log.includes(`-${name}`)).length, 2, `${logs}`);
  assert.deepEqual(dashboard.complaints, []);
});
