// @ts-check
/** A station that dies and is started again, with the page left open. */
import assert from 'node:assert/strict';
import { once } from 'node:events';
import { after, before, test } from 'node:test';
import { folder, open, showPage, start } from '../dashboard.mjs';

/** @type {Awaited<ReturnType<typeof open>>} */
let dashboard;
/** @type {import('playwright-core').Page} */
let page;
/** @type {Awaited<ReturnType<typeof start>> | null} */
let again = null;

before(async () => {
  dashboard = await open(['lab', '--out', folder()]);
  page = dashboard.page;
  await page.waitForSelector('#connection.good');
});

after(async () => {
  again?.server.kill();
  await dashboard?.close();
});

/** @param {string} text */
const notice = (text) => page.locator('#notice', { hasText: text }).waitFor();

test('a station that dies is noticed, and a STOP that does not reach the robot is reported', async () => {
  assert.equal(await page.locator('#notice').isVisible(), false);
  await page.locator('#on').click();
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state().robot.armed);
  dashboard.server.kill('SIGKILL');
  await once(dashboard.server, 'exit');
  await notice('No connection to the station. Trying again…');
  await page.locator('#notice', { hasText: /STOP does not reach the robot/ }).waitFor();
  await page.locator('#connection.bad', { hasText: 'no connection' }).waitFor();
  assert.equal(await page.locator('#map').evaluate((map) => getComputedStyle(map).filter), 'grayscale(1)', 'what is shown is old');
  await page.keyboard.press('Space');
  await page.locator('#events li', { hasText: 'STOP was not sent' }).waitFor();
});

test('a station that is started again has a new key: the page says where to find it, and goes on by itself when it is there', async () => {
  again = await start(['lab', '--out', folder()], Number(new URL(dashboard.url).port));
  await notice('open the address that it printed');
  const other = await showPage(page.context(), again.url);
  await notice('The station is back');
  await page.waitForSelector('#connection.good');
  assert.equal(await page.evaluate(() => /** @type {any} */ (window).rumbo.state().robot.armed), false, 'nothing arms by itself');
  await other.close();
  await page.locator('#notice').waitFor({ state: 'hidden' });
});
