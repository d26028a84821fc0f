// @ts-check
/**
 * The lab of the site, from a plain static server: it drives, STOP stops it, a dropped image runs, and a run has the same
 * bits as natively. TOOLS is the native program for that (tools/), FIRMWARE our image, SKETCHES the folder of
 * built sketches, SCREENSHOT_SITE a file for a picture.
 */
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { existsSync, readFileSync } from 'node:fs';
import { basename, join } from 'node:path';
import { after, before, test } from 'node:test';
import { folder, program } from '../dashboard.mjs';
import { open, share, skip, dropOn } from '../site.mjs';

const SKETCH = join(process.env['SKETCHES'] ?? '', 'memoria-mode5.elf');
const FIRMWARE = process.env['FIRMWARE'] ?? '';
const [CORNERS = '', SQUARE = ''] = ['corners', 'square'].map((name) => new URL(`../../../examples/fleet/${name}.toml`, import.meta.url).pathname);
const SEEDS = 5;

/** @type {Awaited<ReturnType<typeof open>>} */
let site;
/** @type {import('playwright-core').Page} */
let page;

before(async () => {
  if (skip) return;
  site = await open();
  page = site.page;
});

after(() => site?.close());

/** @param {boolean} armed */
const isArmed = (armed) => page.waitForFunction((armed) => /** @type {any} */ (window).rumbo.state()?.robot.armed === armed, armed);

/** @param {string} text */
const says = (text) => page.locator('#events li', { hasText: text }).first().waitFor();

/** Drops a file on the page. @param {string} name @param {Buffer | string} content */
const drop = (name, content) => dropOn(page, [{ name, content }]);

test('the lab starts by itself, in real time, and the robot is not armed by it', { skip }, async () => {
  await page.waitForSelector('#connection.good');
  await isArmed(false);
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.series('left_pwm').t.length > 30);
  const state = await page.evaluate(() => /** @type {any} */ (window).rumbo.state());
  assert.ok(state.simulated && state.speed === 1, JSON.stringify(state));
});

test('it drives to its goal, and STOP stops it on the way to the next', { skip }, async () => {
  await page.locator('#scenario').selectOption('mode8-random');
  await says('reset: mode8-random');
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state().robot.task.goal !== null);
  await page.locator('#speed').selectOption('4');
  await page.locator('#on').click();
  await isArmed(true);
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state().robot.task.end === 'reached');
  if (process.env['SCREENSHOT_SITE']) await page.screenshot({ path: process.env['SCREENSHOT_SITE'] });
  await page.locator('#speed').selectOption('1');
  await page.locator('#goal-x').fill('3');
  await page.locator('#goal-y').fill('1');
  await page.locator('#goal button').click();
  await isArmed(true);
  const turns = () => page.waitForFunction(() => Math.abs(/** @type {any} */ (window).rumbo.series('left_rpm').y.at(-1)) > 10);
  await turns();
  await page.locator('#stop').click();
  await isArmed(false);
  await page.waitForFunction(() => {
    const last = /** @type {any} */ (window).rumbo.series('true_left_rpm').y.slice(-20);
    return last.every((/** @type {number | null} */ rpm) => Math.abs(rpm ?? 0) < 3);
  });
});

test('a link opens the same scenario, seed and parameters, and one for something else says so', { skip }, async () => {
  await page.locator('#seed').fill('7');
  await page.locator('#simulation button[type="submit"]').click();
  await says('seed 7');
  const cruise = page.locator('#parameter-mission_cruise_m_s');
  await page.waitForFunction(() => /** @type {HTMLInputElement | null} */ (document.querySelector('#parameter-mission_cruise_m_s'))?.value === '0.4');
  await cruise.fill('0.25');
  await cruise.press('Enter');
  await says('mission_cruise_m_s = 0.25: acknowledged');
  const link = await share(page);
  await page.keyboard.press('Escape');
  assert.ok(link.href.length < 2_048, link.href);

  const elsewhere = await open({}, link.hash.slice(1));
  await elsewhere.page.waitForFunction(() => /** @type {HTMLInputElement | null} */ (document.querySelector('#parameter-mission_cruise_m_s'))?.value === '0.25');
  assert.equal(await elsewhere.page.locator('#scenario').inputValue(), 'mode8-random');
  assert.equal(await elsewhere.page.locator('#seed').inputValue(), '7');
  assert.deepEqual([...elsewhere.complaints, ...elsewhere.abroad], []);
  await elsewhere.close();

  const wrong = await open({}, 'scenario=mode99&version=0.1.0');
  await wrong.page.locator('#events li', { hasText: 'the link is not for this version' }).first().waitFor();
  assert.equal(await wrong.page.locator('#scenario').inputValue(), 'mode1');
  await wrong.close();
});

test('a run driven by hand is repeated by its link, to the last bit', { skip }, async () => {
  const here = await open({}, 'scenario=mode5&seed=3');
  const { page } = here;
  const said = (/** @type {string} */ text) => page.locator('#events li', { hasText: text }).first().waitFor();
  await page.waitForSelector('#connection.good');
  await said('mode 5 wheel speed: acknowledged');
  await page.locator('#on').click();
  await said('ON: acknowledged');
  await page.locator('#reference input').first().fill('70');
  await page.locator('#reference button').first().click();
  await said('setpoints left 70 rpm, right 70 rpm: acknowledged');
  const base = page.locator('#parameter-link_timeout_s');
  await page.locator('#all-parameters').check();
  await base.fill('0.35');
  await base.press('Enter');
  await said('link_timeout_s = 0.35: acknowledged');
  await page.locator('#stop').click();
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state().robot.armed === false);
  const whole = await share(page);
  await page.locator('#share-drive').waitFor();
  assert.match(whole.hash, /&drive=[^&]*arm[^&]*stop&until_s=[\d.]+&hash=[0-9a-f]{16}&/);
  assert.ok(!whole.hash.includes('&link_timeout_s='), whole.hash);
  assert.ok(whole.href.length < 2_048, whole.href);
  if (process.env['SCREENSHOT_SHARE']) await page.screenshot({ path: process.env['SCREENSHOT_SHARE'] });
  // Without it: as it is set up now.
  await page.locator('#share-drive').uncheck();
  const setUp = new URL(await page.locator('#share-link').inputValue());
  assert.ok(!setUp.hash.includes('drive=') && setUp.hash.includes('link_timeout_s=0.35'), setUp.hash);
  assert.deepEqual([...here.complaints, ...here.abroad], []);
  await here.close();

  const elsewhere = await open({ locale: 'es-ES' }, whole.hash.slice(1));
  await elsewhere.page.waitForSelector('#connection.good');
  await elsewhere.page.locator('#speed').selectOption('8');
  await elsewhere.page.locator('#events li', { hasText: 'esta es la ejecución del enlace, bit a bit' }).first().waitFor();
  assert.deepEqual(await elsewhere.page.evaluate(() => /** @type {any} */ (window).rumbo.untranslated()), []);
  assert.deepEqual([...elsewhere.complaints, ...elsewhere.abroad], []);
  await elsewhere.close();

  const changed = await open({}, whole.hash.slice(1).replace('seed=3', 'seed=4'));
  await changed.page.waitForSelector('#connection.good');
  await changed.page.locator('#speed').selectOption('8');
  await changed.page.locator('#events li', { hasText: 'this is not the run of the link' }).first().waitFor();
  await changed.close();
});

test('what needs a computer says so', { skip }, async () => {
  await drop('blink.ino', 'void setup() {}');
  await says('compiling a sketch needs rumbo on a computer');
  await drop('notes.txt', 'x');
  await says('only an .ino, .elf or .hex file');
  assert.deepEqual(await page.evaluate(() => /** @type {any} */ (window).rumbo.untranslated()), []);
});

test('the run is replayed, as rumbo replay would, and so is a saved one; then the lab goes on', { skip }, async () => {
  const state = () => page.evaluate(() => /** @type {any} */ (window).rumbo.state());
  const replays = (/** @type {boolean} */ shown) => page.waitForFunction((shown) => Boolean(/** @type {any} */ (window).rumbo.state()?.replay) === shown, shown);
  const back = async () => {
    await page.locator('#replay-end').click();
    await replays(false);
  };
  await page.locator('#recordings').click();
  const saved = page.waitForEvent('download');
  await page.getByRole('button', { name: 'Save this run' }).click();
  const download = await saved;
  const path = join(folder(), download.suggestedFilename());
  await download.saveAs(path);
  await page.getByRole('button', { name: 'Replay this run' }).click();
  await replays(true);
  const { t_s, speed, replay } = await state();
  assert.deepEqual([t_s, speed], [0, 0]);
  assert.match(replay.name, /mode8-random-7$/);
  assert.equal(await page.locator('#stop').isVisible(), false);
  // The whole curve, before and after the playhead.
  await page.waitForFunction((end_s) => /** @type {any} */ (window).rumbo.series('left_pwm').t.at(-1) > end_s - 1, replay.duration_s);
  await page.locator('#replay-play').click();
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state().t_s > 0.5);
  await page.locator('#replay-play').click();
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state().speed === 0);
  if (process.env['SCREENSHOT_REPLAY']) await page.screenshot({ path: process.env['SCREENSHOT_REPLAY'] });
  await back();
  assert.equal((await state()).replay, undefined);
  await page.waitForFunction((before_s) => /** @type {any} */ (window).rumbo.state().t_s >= before_s, replay.duration_s);

  const log = readFileSync(path);
  await drop('saved.mcap', log);
  await replays(true);
  assert.equal((await state()).replay.name, 'saved');
  await says('mission_cruise_m_s = 0.25: acknowledged');
  await page.locator('#events li', { hasText: 'mission_cruise_m_s = 0.25: acknowledged' }).first().click();
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state().t_s > 0);
  await back();
  await drop('cut.mcap', log.subarray(0, log.length * 2 / 3));
  await replays(true);
  await page.locator('#events li', { hasText: /the log (?:ends early|is damaged): / }).first().waitFor();
  await back();
  await drop('notes.mcap', 'no log');
  await says('notes.mcap: is no MCAP log; give a log of rumbo, or convert a table or a bag with `rumbo import`');
  assert.equal((await state()).replay, undefined);
  assert.deepEqual(await page.evaluate(() => /** @type {any} */ (window).rumbo.untranslated()), []);
});

test('the run is saved as a log, which runs again natively, byte for byte', { skip: skip || (process.env['RUMBO_BIN'] ? false : 'RUMBO_BIN names no program') }, async () => {
  await page.locator('#recordings').click();
  const saved = page.waitForEvent('download');
  await page.getByRole('button', { name: 'Save this run' }).click();
  const download = await saved;
  await page.keyboard.press('Escape');
  const path = join(folder(), download.suggestedFilename());
  assert.match(path, /\d{8}-\d{6}-mode8-random-7\.mcap$/);
  await download.saveAs(path);
  const again = spawnSync(program(), ['rerun', path], { encoding: 'utf8' });
  assert.equal(again.status, 0, again.stdout + again.stderr);
});

test('a dropped image runs on an emulated Mega with its consoles', { skip: skip || (existsSync(SKETCH) ? false : `${SKETCH} is missing: run \`cargo xtask sketches\``) }, async () => {
  await page.locator('#scenario').selectOption('mode5');
  await says('reset: mode5');
  await drop(basename(SKETCH), readFileSync(SKETCH));
  await says('the changed program runs');
  await page.locator('#program-name', { hasText: 'memoria-mode5.elf' }).waitFor();
  await page.locator('#on').click();
  await page.locator('#console').filter({ hasText: /\d+, ?-?\d/ }).waitFor();
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.series('left_rpm').y.some((/** @type {number} */ rpm) => rpm > 40));
});

test('every scenario has the same bits as natively, and so have several robots and an image', { skip: skip || (process.env['TOOLS'] ? false : 'TOOLS names no program: `cargo build -p rumbo-tools`') }, async () => {
  const images = [SKETCH, FIRMWARE].filter((path) => existsSync(path));
  const native = spawnSync(process.env['TOOLS'] ?? '', ['hashes', String(SEEDS), CORNERS, ...images], { encoding: 'utf8' });
  assert.equal(native.status, 0, native.stderr);
  /** @type {Record<string, string[]>} */
  const expected = JSON.parse(native.stdout);
  const data = Object.fromEntries(images.map((path) => [path, readFileSync(path).toString('base64')]));
  // Of several robots, in files that are not built in.
  const [file, edited] = [CORNERS, SQUARE].map((path) => readFileSync(path, 'utf8'));
  const given = { [CORNERS]: { scenario: 'corners', file, edited } };
  const found = await page.evaluate(async ({ names, data, given, seeds }) => {
    const { default: init, run_hash } = await import(new URL('lab/rumbo.js', location.href).href);
    await init();
    const hashes = (/** @type {string} */ name) => {
      const image = data[name];
      const bytes = Uint8Array.from(atob(image ?? ''), (each) => each.charCodeAt(0));
      if (image) return [run_hash(JSON.stringify({ scenario: 'mode5' }), bytes)];
      return Array.from({ length: seeds }, (_, index) => run_hash(JSON.stringify({ scenario: name, ...given[name], seed: index + 1 }), bytes));
    };
    return Object.fromEntries(names.map((name) => [name, hashes(name)]));
  }, { names: Object.keys(expected), data, given, seeds: SEEDS });
  assert.ok(Object.keys(expected).length > 50);
  assert.deepEqual(found, expected);
});

test('without a network it opens again, from what the browser has kept', { skip }, async () => {
  const here = await open();
  await here.page.waitForSelector('#connection.good');
  await here.page.evaluate(() => navigator.serviceWorker.ready);
  here.unplug();
  await here.page.reload();
  await here.page.waitForSelector('#connection.good');
  await here.page.locator('#on').click();
  await here.page.waitForFunction(() => /** @type {any} */ (window).rumbo.state()?.robot.armed);
  assert.deepEqual([...here.complaints, ...here.abroad], []);
  await here.close();
});

test('nothing is loaded from elsewhere, and no script complains', { skip }, () => {
  assert.deepEqual(site.abroad, []);
  assert.deepEqual(site.complaints, []);
});

test('STOP is whole at each width, beside the links to the other pages too', { skip }, async () => {
  const here = await open({ locale: 'es-ES' });
  await here.page.locator('#pages a').first().waitFor();
  for (const width of [390, 900, 1100, 1280, 1400, 1500]) {
    await here.page.setViewportSize({ width, height: 800 });
    const { x, width: wide } = await here.page.locator('#stop').boundingBox() ?? { x: NaN, width: NaN };
    assert.ok(x >= 0 && x + wide <= width, `${width}: ${x} to ${x + wide}`);
  }
  await here.close();
});
