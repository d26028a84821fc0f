// @ts-check
/** The calibration as a guided page, on the simulated robot. */
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { folder, open } from '../dashboard.mjs';

/** @type {Awaited<ReturnType<typeof open>>} */
let dashboard;
/** @type {import('playwright-core').Page} */
let page;

before(async () => {
  dashboard = await open(['lab', '--out', folder(), '--speed', '16']);
  page = dashboard.page;
  await page.waitForSelector('#connection.good, #connection.warning');
});

after(() => dashboard?.close());

const step = () => page.locator('#calibration-step');

/** Begins a calibration; on a busy machine so fast a robot is at times late to answer, and it is refused. @param {import('playwright-core').Locator} begun what shows that it began */
async function begin(begun) {
  const refused = step().getByText('it was refused: ');
  for (;;) {
    await step().getByRole('button', { name: 'Begin the calibration' }).click();
    await begun.or(refused).waitFor();
    if (!await refused.isVisible()) return;
    await step().getByRole('button', { name: 'Begin again' }).click();
  }
}

test('where there is no wall, or the wrong rig, the calibration reports it', async () => {
  await page.locator('#calibrate').click();
  // It ends at once, mostly between two states that the page gets.
  for (let times = 0; times < 3; times += 1) {
    await begin(step().getByText('The calibration came to no end: a calibration needs a sonar ahead and one on each side'));
    await step().getByRole('button', { name: 'Begin again' }).click();
  }
});

test('STOP ends a calibration, and meanwhile nothing else drives', async () => {
  await step().getByRole('button', { name: 'Put the simulated robot there' }).click();
  await page.locator('#events li', { hasText: 'reset: calibration' }).waitFor();
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state().robot.rig === 'final');
  await begin(step().locator('progress'));
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state().robot.armed);
  await page.locator('#on').click();
  await page.locator('#events li', { hasText: 'refused, the robot calibrates itself; STOP ends that' }).waitFor();
  await page.keyboard.press('Space');
  await step().getByText('it was stopped').waitFor();
  await page.waitForFunction(() => !(/** @type {any} */ (window).rumbo.state().robot.armed));
});

test('the simulated robot calibrates itself: what was found is shown, and its parameters are set', async () => {
  await step().getByRole('button', { name: 'Begin again' }).click();
  await step().getByRole('button', { name: 'Put the simulated robot there' }).click();
  await begin(step().locator('progress'));
  await step().getByText('Done. The parameters are set').or(step().getByText('The calibration came to no end')).waitFor();
  const text = await step().innerText();
  assert.match(text, /^Done/);
  assert.match(text, /radius, right over left\s+(0\.9[89]|1\.0[01])/);
  assert.match(text, /dead zone, left forward, duty\s+0\./);
  const [before, now] = (await step().locator('tr', { hasText: 'base_m' }).last().locator('td').allTextContents()).slice(1);
  assert.equal(before, '0.1');
  assert.ok(Math.abs(Number(now) - 0.1) < 0.004 && now !== before, now);
  await page.waitForFunction((value) => /** @type {HTMLInputElement} */ (document.querySelector('#parameter-base_m')).value === value, now);
  await page.setViewportSize({ width: 390, height: 844 });
  const [wanted = 0, given = 0] = await page.locator('#calibration-dialog').evaluate(({ scrollWidth, clientWidth }) => [scrollWidth, clientWidth]);
  assert.ok(wanted <= given, `on a telephone the tables take ${wanted} px of ${given}`);
  assert.deepEqual(dashboard.complaints, []);
});
