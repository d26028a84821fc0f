// @ts-check
/** The dashboard in Spanish, as a Spanish browser gets it. */
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { eventually, folder, open, rare } from '../dashboard.mjs';

/** @type {Awaited<ReturnType<typeof open>>} */
let dashboard;
/** @type {import('playwright-core').Page} */
let page;

before(async () => {
  dashboard = await open(['lab', '--speed', '4', '--out', folder()], { locale: 'es-ES' });
  page = dashboard.page;
});

after(() => dashboard?.close());

/** @param {RegExp} text */
const event = (text) => page.locator('#events li', { hasText: text }).first().waitFor();

test('a Spanish browser gets the page, the modes and the events in Spanish', async () => {
  await page.locator('#connection', { hasText: /^en vivo \d+ Hz$/ }).waitFor();
  assert.equal(await page.evaluate(() => document.documentElement.lang), 'es');
  await eventually(async () => assert.match(await page.locator('#stop').innerText(), /PARAR/));
  await eventually(async () => assert.equal(await page.locator('#modes button').nth(1).innerText(), '1distancia'));
  await page.locator('#on').click();
  await event(/^\d+,\d\d s.armado$/);
  await page.locator('#state', { hasText: 'acercarse' }).waitFor();
  await event(/referencia alcanzada/);
});

test('refusals and failures are reported in Spanish, with the remedy', async () => {
  const input = page.locator('#parameter-front_kp');
  await input.fill('99');
  await input.press('Enter');
  await event(/front_kp = 99: rechazado, se permite de 0,1 a 20/);
  await page.locator('#stop').click();
  await event(/PARAR: confirmado/);
  await page.locator('#scenario').selectOption('free');
  await page.locator('#simulation button[type=submit]').click();
  await event(/reinicio: free, semilla 1/);
  // While the robot starts once more it refuses, and says so beside the button.
  const mode4 = page.locator('#modes button[value="4"]');
  for (let tries = 0; tries < 10 && (await mode4.getAttribute('aria-pressed')) !== 'true'; tries += 1) {
    await mode4.click();
    await page.locator('#modes button[value="4"][aria-pressed="true"]').waitFor({ timeout: 2000 }).catch(() => {});
  }
  await page.locator('#modes button[value="4"][aria-pressed="true"]').waitFor();
  await page.locator('#on').click();
  // Which of the two depends on the tick in which ON arrives.
  await event(/fallo: (pared perdida: .*; pon el robot frente a una pared|sonar averiado: .*; comprueba su cableado)/);
  await page.locator('#fault-text', { hasText: /^(pared perdida|sonar averiado)/ }).waitFor();
  await page.locator('#clear-fault').click();
  await event(/fallo borrado/);
});

test('numbers have a decimal comma, and fields take a point too', async () => {
  await page.locator('#battery', { hasText: /^\d,\d V$/ }).waitFor();
  await page.locator('#pose', { hasText: /x −?\d+,\d{3} m/ }).waitFor();
  const input = page.locator('#parameter-link_timeout_s');
  for (const [typed, shown] of [['0,3', '0,3'], ['0.35', '0,35']]) {
    await input.fill(/** @type {string} */ (typed));
    await input.press('Enter');
    await event(new RegExp(`link_timeout_s = ${shown}: confirmado`));
    await page.waitForFunction((shown) => /** @type {HTMLInputElement} */ (document.querySelector('#parameter-link_timeout_s')).value === shown, shown);
  }
  await input.press('ArrowUp');
  assert.equal(await input.inputValue(), '0,36');
  await input.press('Escape');
  const place = page.locator('#modes button[value="8"]');
  await place.click();
  await page.locator('#goal-x').fill('0,5');
  await page.locator('#goal-y').fill('-0.25');
  await page.locator('#goal button').click();
  await event(/destino \(0,50; [-−]0,25\) m: confirmado/);
  await page.locator('#aim', { hasText: 'destino (0,5; −0,25) m' }).waitFor();
  // Bytes and the file's name are none.
  const points = await page.evaluate(() => document.body.innerText.split('\n').filter((line) => /\d\.\d/.test(line) && !line.includes('/')));
  assert.deepEqual(points, []);
  const size = page.viewportSize();
  for (const width of [1280, 1000, 390]) {
    await page.setViewportSize({ width, height: 720 });
    await eventually(async () => assert.ok(await page.locator('#aim').evaluate((aim) => aim.scrollWidth <= aim.clientWidth), `at ${width} px the aim is cut`));
  }
  if (size) await page.setViewportSize(size);
});

rare('every mode, parameter and event has been said in Spanish', async () => {
  await page.locator('#all-parameters').check();
  for (const mode of await page.locator('#modes button').all()) {
    await mode.click();
    await page.waitForFunction((value) => String(/** @type {any} */ (window).rumbo.state().robot.mode) === value, await mode.getAttribute('value'));
  }
  for (const tab of await page.getByRole('tab').all()) await tab.click();
  await page.locator('#link-bytes', { hasText: 'telemetría' }).waitFor();
  assert.deepEqual(await page.evaluate(() => /** @type {any} */ (window).rumbo.untranslated()), []);
});

test('the language can be chosen, and is remembered', async () => {
  await page.locator('#language').selectOption('en');
  await page.locator('#stop', { hasText: 'STOP' }).waitFor();
  await page.reload();
  await page.locator('#connection', { hasText: /^live/ }).waitFor();
  assert.equal(await page.locator('#language').inputValue(), 'en');
  assert.deepEqual(dashboard.complaints, []);
});
