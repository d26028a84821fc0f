// @ts-check
/**
 * Several robots in the lab of the site: one is selected, the others are on the map, STOP stops all; a scenario of one's own.
 * SCREENSHOT is a file for a picture.
 */
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, test } from 'node:test';
import { eventually } from '../dashboard.mjs';
import { dropOn, open, share, skip } from '../site.mjs';

const [CORNERS, SQUARE] = ['corners', 'square'].map((name) => new URL(`../../../examples/fleet/${name}.toml`, import.meta.url).pathname);

/** @type {Awaited<ReturnType<typeof open>>} */
let site;
/** @type {import('playwright-core').Page} */
let page;

before(async () => {
  if (skip) return;
  site = await open({}, 'scenario=mode6&robots=3');
  page = site.page;
});

after(() => site?.close());

const state = () => page.evaluate(() => /** @type {import('../../src/types.js').State} */ (/** @type {any} */ (window).rumbo.state()));

const others = () => page.evaluate(() => /** @type {{name: string, x_m: number, y_m: number}[]} */ (/** @type {any} */ (window).rumbo.others()));

/** Goes over to a robot. @param {string} name */
async function show(name) {
  await page.locator('#robot').selectOption(name);
  await eventually(async () => assert.ok((await others()).length > 0 && (await others()).every((other) => other.name !== name)));
  assert.equal(await page.locator('#robot').inputValue(), name);
}

/** @param {boolean} armed */
const isArmed = (armed) => eventually(async () => assert.equal((await state()).robot.armed, armed));

test('each robot is driven for itself, and the lab goes on when the page goes over to another', { skip }, async () => {
  await page.waitForSelector('#connection.good');
  assert.deepEqual(await page.locator('#robot option').allTextContents(), ['robot1', 'robot2', 'robot3']);
  assert.equal(await page.locator('#robots').inputValue(), '3');
  for (const name of ['robot2', 'robot3']) {
    await show(name);
    assert.equal(await page.locator('#simulation').isVisible(), false, 'the first one has the choice');
    await isArmed(false);
    await page.locator('#on').click();
    await isArmed(true);
  }
  await show('robot1');
  await isArmed(false);
  const before = await others();
  await eventually(async () => {
    const now = await others();
    assert.ok(now.every(({ x_m, y_m }, index) => Math.hypot(x_m - (before[index]?.x_m ?? 0), y_m - (before[index]?.y_m ?? 0)) > 0.1));
  });
  if (process.env['SCREENSHOT']) await page.screenshot({ path: process.env['SCREENSHOT'] });
});

test('STOP stops all', { skip }, async () => {
  await page.locator('#stop').click();
  for (const name of ['robot2', 'robot3', 'robot1']) {
    await show(name);
    await isArmed(false);
  }
});

test('a program that is dropped where there are several robots says what to do instead', { skip }, async () => {
  await dropOn(page, [{ name: 'blink.hex', content: ':00000001FF' }]);
  await page.locator('#events li', { hasText: 'set robots to 1, or choose a scenario with one' }).first().waitFor();
});

test('what is wrong with a dropped file is said in Spanish, with the words and numbers of the file', { skip }, async () => {
  const spanish = await open({ locale: 'es-ES' });
  await spanish.page.waitForSelector('#connection.good');
  const says = (/** @type {string} */ text) => spanish.page.locator('#events li', { hasText: text }).first().waitFor();
  const scenario = 'title = "x"\nrobot = "memoria"\nrig = "front_single"\nworld = "open"\nmode = "front_dist"\nduration_s = 9000.5\nseconds = 1\n';
  await dropOn(spanish.page, [{ name: 'mine.toml', content: scenario }]);
  await says('escenario mine, línea 5: mode = front_dist: modo desconocido; ¿quizá `front_distance` (1) o `front_align` (2)?');
  await says('escenario mine, línea 6: duration_s = 9000.5: debe estar entre');
  await says('escenario mine, línea 7: seconds = 1: clave desconocida');
  await dropOn(spanish.page, [{ name: 'cut.hex', content: ':0000000100\n' }]);
  await says('programa: rechazado, firmware cut.hex: la línea 1 del archivo HEX está mal: su suma de comprobación es FF, y debería ser 00');
  assert.deepEqual(await spanish.page.evaluate(() => /** @type {any} */ (window).rumbo.untranslated()), []);
  await spanish.close();
});

test('another number of robots begins anew, and is in the link', { skip }, async () => {
  await page.locator('#robots').fill('2');
  await page.locator('#robots').press('Enter');
  await eventually(async () => assert.deepEqual(await page.locator('#robot option').allTextContents(), ['robot1', 'robot2']));
  assert.ok((await state()).t_s < 5);
  const link = await share(page);
  assert.match(link.hash, /scenario=mode6&.*robots=2/);
  await page.keyboard.press('Escape');
  await page.locator('#robots').fill('1');
  await page.locator('#robots').press('Enter');
  await eventually(async () => assert.equal(await page.locator('#robot').isVisible(), false));
});

test('a scenario of one\'s own is dropped with its world, and its link opens it', { skip }, async () => {
  const files = [CORNERS, SQUARE].map((path = '') => ({ name: path.split('/').at(-1) ?? '', content: readFileSync(path, 'utf8') }));
  await dropOn(page, files.slice(0, 1));
  await page.locator('#events li', { hasText: 'square.toml' }).first().waitFor();
  await dropOn(page, files.slice(1));
  await page.locator('#events li', { hasText: 'no scenario is among these files' }).first().waitFor();
  await dropOn(page, files);
  const names = ['south_west', 'south_east', 'north_east', 'north_west'];
  await eventually(async () => assert.deepEqual(await page.locator('#robot option').allTextContents(), names));
  const link = await share(page);
  await page.keyboard.press('Escape');
  const elsewhere = await open({}, link.hash.slice(1));
  await eventually(async () => assert.deepEqual(await elsewhere.page.locator('#robot option').allTextContents(), names));
  assert.deepEqual([...elsewhere.complaints, ...elsewhere.abroad], []);
  await elsewhere.close();
});

test('nothing is loaded from elsewhere, and no script complains', { skip }, () => {
  assert.deepEqual([...site.abroad, ...site.complaints], []);
});
