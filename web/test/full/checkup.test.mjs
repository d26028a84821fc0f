// @ts-check
/** The first check of a robot: the guided page on the simulated robot. */
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { folder, open } from '../dashboard.mjs';

/** @type {Awaited<ReturnType<typeof open>>} */
let dashboard;
/** @type {import('playwright-core').Page} */
let page;

before(async () => {
  dashboard = await open(['lab', '--scenario', 'manual-curve-air-forward', '--rig', 'final', '--out', folder()]);
  page = dashboard.page;
  await page.waitForSelector('#connection.good');
});

after(() => dashboard?.close());

test('the guide turns one wheel at a time, measures it, and leaves the robot disarmed', async () => {
  const step = page.locator('#checkup-step');
  await page.locator('#checkup').click();
  await step.getByRole('button', { name: 'The wheels hang free' }).click();
  await step.getByText('The link works').waitFor();
  await step.getByRole('button', { name: 'Next' }).click();
  for (const side of ['left', 'right']) {
    await step.getByRole('button', { name: 'Turn it' }).click();
    const other = side === 'left' ? 'right' : 'left';
    await step.getByText(new RegExp(`${side} up to [1-9]\\d+ rpm`)).waitFor();
    assert.match(await step.innerText(), new RegExp(`${other} up to 0 rpm`));
    await step.getByRole('button', { name: `the ${side} wheel turned forward` }).click();
    await step.getByText(`The ${side} wheel turns forward, and its encoder counts.`).waitFor();
    await step.getByRole('button', { name: 'Next' }).click();
  }
  for (;;) {
    const skip = step.getByRole('button', { name: 'Skip' });
    if (!await skip.isVisible()) break;
    await skip.click();
  }
  await step.getByRole('button', { name: 'to the left', exact: true }).click();
  await step.getByText('put it back a tooth further to the right').waitFor();
  await step.getByRole('button', { name: 'Next' }).click();
  await step.getByText('There is something to put right:').waitFor();
  assert.equal(await step.locator('li.failed').count(), 1);
  await page.waitForFunction(() => !(/** @type {any} */ (window).rumbo.state().robot.armed));
});

test('STOP can be pressed in the middle of it, and closing lets go', async () => {
  const step = page.locator('#checkup-step');
  await step.getByRole('button', { name: 'Begin again' }).click();
  await step.getByRole('button', { name: 'The wheels hang free' }).click();
  await step.getByRole('button', { name: 'Next' }).click();
  await step.getByRole('button', { name: 'Turn it' }).click();
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state().robot.armed);
  await page.locator('#stop').click();
  await page.waitForFunction(() => !(/** @type {any} */ (window).rumbo.state().robot.armed));
  await page.keyboard.press('Escape');
  await page.locator('#checkup-dialog').waitFor({ state: 'hidden' });
  assert.deepEqual(dashboard.complaints, []);
});
