// @ts-check
/** The ghost: a simulated robot that gets the same commands, beside a replayed robot and beside one on a port. */
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { join } from 'node:path';
import { createInterface } from 'node:readline';
import { test } from 'node:test';
import { eventually, folder, open, program } from '../dashboard.mjs';

/** The value of a signal at the time shown, or the last one before. @param {import('playwright-core').Page} page @param {string} name @returns {Promise<number>} */
const last = (page, name) => page.evaluate((name) => {
  const { series, shown } = /** @type {any} */ (window).rumbo;
  const { t, y } = series(name);
  return y.filter((/** @type {unknown} */ each, /** @type {number} */ at) => typeof each === 'number' && t[at] <= shown().t_s).at(-1);
}, name);

/**
 * ON until robot and ghost stand side by side where the reference is. A busy machine can keep the station from its heartbeats for longer than a
 * robot drives on unheard; then both stop, or one of them, which is right of them: they are cleared and started again.
 * @param {import('playwright-core').Page} page
 */
async function driveThere(page) {
  const stopped = page.locator('#events li', { hasText: 'the ghost has stopped: link lost' });
  for (let seen = 0; ;) {
    await page.locator('#on').click();
    const what = await page.waitForFunction((seen) => {
      const { series, state } = /** @type {any} */ (window).rumbo;
      const last = (/** @type {string} */ name) => series(name).y.filter((/** @type {unknown} */ each) => typeof each === 'number').at(-1);
      const [ghost, robot] = [last('ghost_x_m'), last('x_m')];
      if (state().robot.task.end === 'reached' && robot > 0.5 && Math.abs(ghost - robot) < 0.1) return 'there';
      if (state().robot.fault !== null) return 'robot';
      const lines = [...document.querySelectorAll('#events li')].filter((line) => line.textContent?.includes('the ghost has stopped: link lost'));
      return lines.length > seen ? 'ghost' : null;
    }, seen);
    const which = await what.jsonValue();
    if (which === 'there') return;
    seen = await stopped.count();
    // Alone it hears of no fault being cleared, but starts free of its own.
    if (which === 'ghost') await page.locator('#ghost-here').click();
    const fault = await page.evaluate(() => /** @type {any} */ (window).rumbo.state().robot.fault);
    if (fault === null) continue;
    assert.match(fault, /^link lost/);
    await page.locator('#clear-fault').click();
    await page.locator('#fault').waitFor({ state: 'hidden' });
  }
}

test('the ghost of a simulated log goes where its robot went', async () => {
  const out = folder();
  spawnSync(program(), ['run', 'mode1', '--seed', '3', '--out', out]);
  const dashboard = await open(['replay', join(out, 'mode1-3.mcap'), '--ghost', '--speed', '16']);
  try {
    const { page } = dashboard;
    await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state()?.t_s > 5);
    await page.locator('#map-legend', { hasText: 'ghost' }).waitFor();
    const [ghost, truth] = [await last(page, 'ghost_x_m'), await last(page, 'true_x_m')];
    assert.ok(Math.abs(ghost - truth) < 0.05 && truth > 0.3, `${ghost}, ${truth}`);
    // Its signals stand over the robot's: the same plant, the same bytes.
    const [itsRange, range] = [await last(page, 'ghost_range_front_cm'), await last(page, 'true_range_front_cm')];
    assert.ok(Math.abs(itsRange - range) < 5, `${itsRange}, ${range}`);
    assert.equal(typeof await last(page, 'ghost_left_rpm'), 'number');
    await page.locator('.plot-curves .curve', { hasText: 'ghost front' }).waitFor();
    // Started again in the middle, it goes on from where the robot is, and so gets to the same place.
    await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state().speed === 0);
    await page.locator('#replay-scrub').evaluate((input) => {
      /** @type {HTMLInputElement} */ (input).value = '2';
      input.dispatchEvent(new Event('change'));
    });
    await page.waitForFunction(() => Math.abs(/** @type {any} */ (window).rumbo.state().t_s - 2) < 0.01);
    await page.locator('#ghost-here').click();
    await page.locator('#events li', { hasText: 'the ghost starts again where the robot is' }).waitFor();
    await page.locator('#replay-play').click();
    await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state().t_s > 5);
    const [again, there] = [await last(page, 'ghost_x_m'), await last(page, 'true_x_m')];
    assert.ok(Math.abs(again - there) < 0.05 && there > 0.3, `${again}, ${there}`);
    assert.deepEqual(dashboard.complaints, []);
  } finally {
    await dashboard.close();
  }
});

test('a ghost that is in another place is put beside the robot, and goes on from there', async () => {
  const out = folder();
  spawnSync(program(), ['run', 'mode1', '--seed', '3', '--out', out]);
  // In the world of mode 4 it has its wall elsewhere, and begins elsewhere.
  const dashboard = await open(['replay', join(out, 'mode1-3.mcap'), '--ghost', 'mode4', '--speed', '0']);
  try {
    const { page } = dashboard;
    await page.locator('#replay-on').click();
    await page.locator('#map-legend', { hasText: 'ghost' }).waitFor();
    await page.locator('#replay-scrub').evaluate((input) => {
      /** @type {HTMLInputElement} */ (input).value = '4';
      input.dispatchEvent(new Event('change'));
    });
    await page.waitForFunction(() => Math.abs(/** @type {any} */ (window).rumbo.state().t_s - 4) < 0.01);
    const apart = async () => Math.hypot(await last(page, 'ghost_x_m') - await last(page, 'true_x_m'), await last(page, 'ghost_y_m') - await last(page, 'true_y_m'));
    assert.ok(await apart() > 0.1, 'it is elsewhere');
    await page.locator('#ghost-here').click();
    await page.waitForFunction(() => {
      const { ghost, truth } = /** @type {any} */ (window).rumbo.shown() ?? {};
      return ghost && truth && Math.hypot(ghost.x_m - truth.x_m, ghost.y_m - truth.y_m) < 0.01;
    });
  } finally {
    await dashboard.close();
  }
});

test('the ghost of a robot on a port receives the same commands', { skip: process.platform === 'win32' }, async () => {
  const robot = spawn(program(), ['lab', '--scenario', 'mode1', '--pty'], { stdio: ['ignore', 'pipe', 'inherit'] });
  let port = '';
  for await (const line of createInterface({ input: robot.stdout })) {
    port = line.match(/\/dev\/\S+/)?.[0] ?? '';
    if (port) break;
  }
  const dashboard = await open(['connect', port, '--ghost', 'mode1', '--out', folder()]);
  try {
    const { page } = dashboard;
    await page.locator('#connection.good').waitFor();
    // The first time that this browser meets a real robot, the check comes by itself, for the sonars that the robot carries.
    await page.locator('#checkup-dialog').waitFor();
    await eventually(async () => assert.deepEqual((await page.locator('#checkup-dialog .steps li').allTextContents()).slice(6), ['Sonar: front'], 'its rig has no servo'));
    await page.keyboard.press('Escape');
    await page.reload();
    await page.locator('#connection.good').waitFor();
    await page.locator('#parameters input').first().waitFor();
    assert.equal(await page.locator('#checkup-dialog').isVisible(), false, 'once');
    // Its sonar's cone is drawn, though nothing is simulated for it.
    await page.waitForFunction(() => {
      const canvas = /** @type {HTMLCanvasElement} */ (document.querySelector('#map'));
      const pixels = canvas.getContext('2d')?.getImageData(0, 0, canvas.width, canvas.height).data ?? [];
      let found = 0;
      for (let at = 0; at < pixels.length; at += 4) if ((pixels[at + 1] ?? 0) > 200 && (pixels[at] ?? 0) < 100) found += 1;
      return found > 20;
    });
    assert.equal(await page.locator('#simulation').isVisible(), false, 'a robot on a port is no simulation');
    await page.locator('#modes button[value="1"]').click();
    await page.locator('#reference-cm').fill('30');
    await page.locator('#reference-cm').press('Enter');
    await driveThere(page);
    const [ghost, robot] = [await last(page, 'ghost_x_m'), await last(page, 'x_m')];
    assert.ok(Math.abs(ghost - robot) < 0.1 && robot > 0.5, `${ghost}, ${robot}`);
    // A hand would have to carry a real robot; the ghost goes by itself to where it is.
    const before_s = await page.evaluate(() => /** @type {any} */ (window).rumbo.series('x_m').t.at(-1));
    const starts = page.locator('#events li', { hasText: 'the ghost starts again where the robot is' });
    const before = await starts.count();
    await page.locator('#ghost-here').click();
    await starts.nth(before).waitFor();
    // From there it goes on as its own sonar says: what counts is that it was there.
    await page.waitForFunction((before_s) => {
      const { series } = /** @type {any} */ (window).rumbo;
      const [ghost, robot] = [series('ghost_x_m'), series('x_m')];
      return ghost.t.some((/** @type {number} */ t, /** @type {number} */ at) => t > before_s && Math.abs(ghost.y[at] - robot.y[at]) < 0.01);
    }, before_s);
    // The robot's clock began before the station listened.
    await page.getByRole('tab', { name: 'Link' }).click();
    await page.locator('#link-figures', { hasText: /robot started at[-−]?[\d.]+ s/ }).waitFor();
    if (process.env['SCREENSHOT_GHOST']) await page.screenshot({ path: process.env['SCREENSHOT_GHOST'] });
    await page.locator('#stop').click();
    await page.waitForFunction(() => !(/** @type {any} */ (window).rumbo.state().robot.armed));
    assert.deepEqual(dashboard.complaints, []);
  } finally {
    await dashboard.close();
    robot.kill();
  }
});
