// @ts-check
/** The world editor on the lab of a station: by pointer, keys, fields and fingers; driven, saved, opened, recorded. */
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import { readdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { eventually, folder, open, program, rare, showPage } from '../dashboard.mjs';

/** @typedef {import('playwright-core').Page} Page */

/** Where a place of the world is on the page [px]. @param {Page} page @param {[number, number]} at @returns {Promise<[number, number]>} */
async function onPage(page, at) {
  const [x, y] = await page.evaluate((at) => /** @type {any} */ (window).rumbo.worldOnMap(at), at);
  const box = await page.locator('#map').boundingBox();
  return [x + (box?.x ?? 0), y + (box?.y ?? 0)];
}

/** Drags with the mouse. @param {Page} page @param {[number, number]} from [m] @param {[number, number]} to [m] */
async function drag(page, from, to) {
  await page.mouse.move(...await onPage(page, from));
  await page.mouse.down();
  await page.mouse.move(...await onPage(page, [(from[0] + to[0]) / 2, (from[1] + to[1]) / 2]));
  await page.mouse.move(...await onPage(page, to));
  await page.mouse.up();
}

/** The numbers in the fields of what is selected. @param {Page} page */
const fields = (page) => page.locator('#editor-fields input.decimal').evaluateAll((inputs) => inputs.map((input) => Number(/** @type {HTMLInputElement} */ (input).value)));
/** @param {Page} page */
const chosen = (page) => page.locator('#editor-item').inputValue();
/** @param {Page} page @param {string} name */
const press = (page, name) => page.locator('#editor').getByRole('button', { name, exact: true }).click();

/** @param {Page} page */
async function edit(page) {
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state()?.link.connected);
  await page.click('#edit-world');
  await page.waitForSelector('#editor:not([hidden])');
}

test('shapes are added, dragged on the grid, typed, turned, deleted, and all of it is taken back', async () => {
  const { page, complaints, close } = await open(['lab', '--scenario', 'mode1', '--out', folder()]);
  try {
    await edit(page);
    await press(page, '+ Box');
    assert.equal(await chosen(page), 'box 0');
    for (const [index, value] of ['0.5', '0.5', '0.2', '0.4', '0'].entries()) await page.fill(`#editor-${index}`, value);
    await drag(page, [0.5, 0.5], [0.31, 0.68]);
    assert.deepEqual(await fields(page), [0.3, 0.7, 0.2, 0.4, 0]);
    // A corner; the one across stays.
    await drag(page, [0.4, 0.9], [0.61, 0.79]);
    assert.deepEqual(await fields(page), [0.4, 0.65, 0.4, 0.3, 0]);
    await page.focus('#map');
    await page.keyboard.press('[');
    await page.keyboard.press('ArrowRight');
    assert.deepEqual(await fields(page), [0.45, 0.65, 0.4, 0.3, 5]);
    await page.keyboard.press('Control+z');
    assert.deepEqual(await fields(page), [0.4, 0.65, 0.4, 0.3, 0]);
    await page.keyboard.press('Control+y');
    assert.deepEqual(await fields(page), [0.45, 0.65, 0.4, 0.3, 5]);
    await press(page, '+ Wall');
    assert.match(await chosen(page), /^wall /);
    await page.focus('#map');
    await page.keyboard.press('Delete');
    assert.equal(await chosen(page), 'arena 0');
    await page.selectOption('#editor-item', 'start 0');
    await page.fill('#editor-2', '90');
    for (; await page.locator('#editor').getByRole('button', { name: 'Undo' }).isEnabled();) await press(page, 'Undo');
    assert.equal(await page.locator('#editor-item option[value^=box]').count(), 0);
    assert.deepEqual(complaints, []);
  } finally {
    await close();
  }
});

test('what no world file may hold is said in the words for files, and Drive here waits', async () => {
  const { page, close } = await open(['lab', '--scenario', 'mode1', '--out', folder()]);
  try {
    await edit(page);
    await press(page, '+ Box');
    await page.fill('#editor-0', '0');
    await page.fill('#editor-1', '0');
    const drive = page.locator('#editor').getByRole('button', { name: 'Drive here' });
    await page.waitForFunction(() => document.querySelector('#editor-problem')?.textContent?.includes('is inside a wall or box of world edited'));
    assert.equal(await drive.isDisabled(), true);
    await page.fill('#editor-0', '0.7');
    await page.fill('#editor-2', '0');
    await page.waitForFunction(() => document.querySelector('#editor-problem')?.textContent?.includes('must be within 0.01..50 m'));
    await page.fill('#editor-2', '0.2');
    await page.waitForFunction(() => document.querySelector('#editor-problem')?.textContent === '');
    assert.equal(await drive.isEnabled(), true);
  } finally {
    await close();
  }
});

test('the robot drives in the edited world; its recording and the saved file make the same runs natively', async () => {
  const out = folder();
  const { page, server, complaints, close } = await open(['lab', '--scenario', 'mode1', '--out', out], { acceptDownloads: true });
  try {
    await edit(page);
    await page.fill('#editor-title', 'Mine');
    await press(page, '+ Box');
    for (const [index, value] of ['0.8', '0', '0.2', '0.4', '10'].entries()) await page.fill(`#editor-${index}`, value);
    const [saved] = await Promise.all([page.waitForEvent('download'), press(page, 'Save file')]);
    assert.equal(saved.suggestedFilename(), 'mine.toml');
    const file = join(out, 'mine.toml');
    await saved.saveAs(file);
    await press(page, 'Drive here');
    await page.waitForSelector('#editor', { state: 'hidden' });
    await eventually(async () => assert.equal(await page.locator('#world').inputValue(), 'edited'));
    assert.equal(await page.locator('#world option:checked').textContent(), 'edited: Mine');
    await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state()?.link.connected);
    assert.equal(await page.evaluate(() => /** @type {any} */ (window).rumbo.state().robot.armed), false);
    await page.click('#on');
    // It comes to rest before the box, and not before the wall behind it.
    await page.waitForFunction(() => {
      const y = /** @type {any} */ (window).rumbo.series('range_front_cm').y.filter((/** @type {unknown} */ each) => typeof each === 'number').slice(-25);
      return y.length === 25 && y.every((/** @type {number} */ each) => Math.abs(each - 30) < 3);
    });
    assert.ok(await page.evaluate(() => /** @type {any} */ (window).rumbo.shown().truth.x_m) < 0.5);
    assert.deepEqual(complaints, []);
    await page.click('#stop');
  } finally {
    const gone = new Promise((done) => server.once('exit', done));
    await close();
    await gone;
  }
  const logs = readdirSync(out).filter((name) => name.endsWith('.mcap')).sort();
  const reruns = logs.map((name) => execFileSync(program(), ['rerun', join(out, name)], { encoding: 'utf8' }));
  // One that is not the same ends with status 1.
  assert.ok(reruns.length >= 2, reruns.join());
  // A limit may be missed there: status 1.
  const run = spawnSync(program(), ['run', 'mode1', '--world', join(out, 'mine.toml'), '--json'], { encoding: 'utf8' });
  assert.ok(run.status !== null && run.status < 2, run.stderr);
  assert.match(run.stdout, /"step1.settling_s"/);
});

rare('a file is opened, keys that the editor does not know stay in it, and one that is none says so', async () => {
  const { page, close } = await open(['lab', '--scenario', 'mode1', '--out', folder()], { acceptDownloads: true });
  try {
    await edit(page);
    const file = join(folder(), 'world.toml');
    writeFileSync(file, 'title = "A file"\n[[box]]\ncentre_m = [1, 1]\nsize_m = [0.2, 0.2]\n[start]\nx_m = -0.5\n');
    await page.setInputFiles('#editor input[type=file]', file);
    await page.waitForFunction(() => /** @type {HTMLInputElement} */ (document.querySelector('#editor-title')).value === 'A file');
    assert.equal(await page.locator('#editor-item option[value^=box]').count(), 1);
    writeFileSync(file, 'title = 0,5\n');
    await page.setInputFiles('#editor input[type=file]', file);
    await page.waitForFunction(() => document.querySelector('#editor-problem')?.textContent?.includes('not valid TOML'));
    assert.equal(await page.locator('#editor-title').inputValue(), 'A file');
  } finally {
    await close();
  }
});

rare('a random world is frozen by its seed, and a page without control only watches', async () => {
  const { page, url, close } = await open(['lab', '--scenario', 'mode8-random', '--seed', '7', '--out', folder()]);
  try {
    await edit(page);
    assert.ok(await page.locator('#editor-item option[value^=box]').count() > 1);
    assert.equal(await page.locator('#editor-item option[value^=goal]').count(), 1);
    assert.ok(url);
    const other = await showPage(page.context(), new URL('/', url).href);
    await other.click('#edit-world');
    await other.locator('#nope', { hasText: 'another page has control' }).waitFor();
    assert.equal(await other.locator('#editor').isHidden(), true);
  } finally {
    await close();
  }
});

rare('fingers move a box on a telephone', async () => {
  const { page, close } = await open(['lab', '--scenario', 'mode1', '--out', folder()], { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true });
  try {
    await edit(page);
    await press(page, '+ Box');
    for (const [index, value] of ['0.5', '0.5', '0.2', '0.4', '0'].entries()) await page.fill(`#editor-${index}`, value);
    await page.locator('#map').scrollIntoViewIfNeeded();
    const client = await page.context().newCDPSession(page);
    const [[x0, y0], [x1, y1]] = [await onPage(page, [0.5, 0.5]), await onPage(page, [0.31, 0.69])];
    const at = (/** @type {number} */ x, /** @type {number} */ y) => ({ touchPoints: [{ x, y }] });
    await client.send('Input.dispatchTouchEvent', { type: 'touchStart', ...at(x0, y0) });
    await client.send('Input.dispatchTouchEvent', { type: 'touchMove', ...at((x0 + x1) / 2, (y0 + y1) / 2) });
    await client.send('Input.dispatchTouchEvent', { type: 'touchMove', ...at(x1, y1) });
    await client.send('Input.dispatchTouchEvent', { type: 'touchEnd', touchPoints: [] });
    await eventually(async () => assert.deepEqual((await fields(page)).slice(0, 2), [0.3, 0.7]));
  } finally {
    await close();
  }
});
