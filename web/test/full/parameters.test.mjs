// @ts-check
/** What the page makes of the modes' descriptions and the parameters' types. */
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { eventually, folder, open } from '../dashboard.mjs';

/** @type {Awaited<ReturnType<typeof open>>} */
let dashboard;
/** @type {import('playwright-core').Page} */
let page;

before(async () => {
  dashboard = await open(['lab', '--scenario', 'mode1', '--out', folder()]);
  page = dashboard.page;
});

after(() => dashboard?.close());

/** @param {string} text */
const event = (text) => page.locator('#events li', { hasText: text }).first().waitFor();

/** @param {number} mode */
async function select(mode) {
  await page.locator(`#modes button[value="${mode}"]`).click();
  await page.waitForFunction((mode) => /** @type {any} */ (window).rumbo.state().robot.mode === mode, mode);
}

/** The titles of the groups that are shown, each with its first parameters. @param {number} [count] of each group */
const groups = (count = 2) => page.evaluate((count) => {
  /** @type {string[][]} */
  const found = [];
  for (const row of document.querySelectorAll('#parameters tr:not([hidden])')) {
    if (row.className.includes('group')) found.push([row.textContent ?? '']);
    else if ((found.at(-1)?.length ?? 0) <= count) found.at(-1)?.push(row.querySelector('td')?.textContent ?? '');
  }
  return found;
}, count);

test('the mode\'s parameters come first, in groups, then the robot\'s; the other modes\' on request', async () => {
  await page.waitForFunction(() => document.querySelectorAll('#parameters .group').length > 0);
  assert.deepEqual((await groups()).slice(0, 2), [['approach to the wall', 'front_cruise_m_s', 'front_kp'], ['straightening', 'front_heading_kp']]);
  assert.deepEqual((await groups()).at(-1), ['the robot', 'radius_left_m', 'radius_right_m']);
  await page.locator('#all-parameters').check();
  assert.equal((await groups()).at(-1)?.[0], 'other modes');
  await page.locator('#all-parameters').uncheck();
});

test('a mode that shares parameters with another shows them too', async () => {
  await select(3);
  assert.deepEqual((await groups())[0], ['along the wall', 'wall_cruise_m_s', 'wall_stop_m']);
});

test('a mode that the rig cannot serve is reported, and its experiment offered', async () => {
  await select(8);
  await page.locator('#about', { hasText: /^needs the sensor layout final$/ }).waitFor();
  await page.locator('#mode-scenario', { hasText: 'Load a scenario of this mode' }).waitFor();
  await select(1);
  await page.locator('#about', { hasText: /^stop at a distance from the wall ahead$/ }).waitFor();
  await eventually(async () => assert.equal(await page.locator('#mode-scenario').isVisible(), false));
});

test('a choice is one of its names, and applied like any value', async () => {
  await select(7);
  const field = page.locator('select#parameter-waypoint_tracker');
  await page.waitForFunction(() => /** @type {HTMLSelectElement} */ (document.querySelector('#parameter-waypoint_tracker')).value === '0');
  await eventually(async () => assert.deepEqual(await field.locator('option').allTextContents(), ['straight', 'pure pursuit']));
  const row = page.locator('#parameters tr', { has: field });
  await field.selectOption('pure pursuit');
  await row.getByRole('button', { name: 'Revert' }).click();
  assert.equal(await field.inputValue(), '0');
  await field.selectOption('pure pursuit');
  await row.getByRole('button', { name: 'Apply' }).click();
  await event('waypoint_tracker = pure pursuit: acknowledged');
  await row.getByRole('button', { name: 'Apply' }).waitFor({ state: 'hidden' });
  assert.equal(await field.inputValue(), '1');
});

test('a switch is ticked, by the keyboard too', async () => {
  await select(8);
  const field = page.locator('#parameter-mission_reset_origin');
  await page.waitForFunction(() => {
    const { checked, indeterminate } = /** @type {HTMLInputElement} */ (document.querySelector('#parameter-mission_reset_origin'));
    return checked && !indeterminate;
  });
  await field.focus();
  await page.keyboard.press('Enter');
  assert.equal(await field.isChecked(), false);
  await page.locator('#parameters tr', { has: field }).getByRole('button', { name: 'Apply' }).click();
  await event('mission_reset_origin = no: acknowledged');
  assert.equal(await field.isChecked(), false);
  assert.deepEqual(dashboard.complaints, []);
});
