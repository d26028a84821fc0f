// @ts-check
/** *Tune* at a station: what `rumbo tune` finds, shown, set and saved; its refusals; the session goes on. RUMBO_BIN is both programs. */
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { violations } from '../axe.mjs';
import { eventually, folder, open, program, rare, showPage } from '../dashboard.mjs';

/** @type {Awaited<ReturnType<typeof open>>} */
let dashboard;
/** @type {import('playwright-core').Page} */
let page;

before(async () => {
  dashboard = await open(['lab', '--out', folder()]);
  page = dashboard.page;
  await page.waitForSelector('#connection.good, #connection.warning');
});

after(() => dashboard?.close());

/** Opens the dialog. @param {import('playwright-core').Page} page */
async function ask(page) {
  await page.locator('#tune').click();
  await page.locator('#tune-start:enabled').waitFor();
}

/** Ticks these parameters only. @param {import('playwright-core').Page} page @param {string[]} names */
async function choose(page, names) {
  const ticked = page.locator('#tune-parameters input:checked');
  while (await ticked.count() > 0) await ticked.first().uncheck();
  for (const name of names) await page.locator('#tune-parameters').getByRole('checkbox', { name: new RegExp(`^${name} `) }).check();
}

const complaint = () => page.locator('#tune-dialog .complaint');

test('the scenario that is loaded and the parameters that matter most are offered first', async () => {
  await ask(page);
  assert.equal(await page.locator('#tune-scenario').inputValue(), 'mode1');
  const offered = await page.locator('#tune-scenario option').evaluateAll((all) => all.map((each) => /** @type {HTMLOptionElement} */ (each).value));
  assert.ok(offered.includes('mode5') && !offered.includes('calibration') && offered.length > 20, offered.join(' '));
  const ticked = await page.locator('#tune-parameters label:has(:checked)').allInnerTexts();
  assert.ok(ticked.length === 3 && ticked.some((text) => text.includes('front_kp')), ticked.join(', '));
  assert.match(await page.locator('#tune-dialog').innerText(), /limits: .*step1\.settling_s ≤ 2\.4/);
  assert.deepEqual(await violations(page, '#tune-dialog'), []);
  if (process.env['SCREENSHOT_TUNE']) await page.screenshot({ path: `${process.env['SCREENSHOT_TUNE']}-form.png` });
});

test('what makes no sense is refused in the words of the command line', async () => {
  await choose(page, []);
  await page.locator('#tune-start').click();
  await complaint().getByText('choose a parameter').waitFor();
  await choose(page, ['front_kp']);
  for (const [aims, why] of /** @type {const} */ ([['setling_s', 'unknown metric `setling_s`; did you mean `settling_s`'], ['settling_s < x', 'its limit is not a number'], ['a b', 'write metrics and limits with commas']])) {
    await page.locator('#tune-aims').fill(aims);
    await page.locator('#tune-start').click();
    await complaint().getByText(why).waitFor();
    await page.locator('#tune-start:enabled').waitFor();
  }
});

test('a search is cancelled, and meanwhile STOP works and the session goes on', async () => {
  await page.locator('#tune-aims').fill('');
  await page.locator('#tune-runs').fill('100000');
  await page.locator('#tune-start').click();
  await page.locator('#tune-left', { hasText: 'at most' }).waitFor();
  await page.locator('#on').click();
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state().robot.armed);
  await page.locator('#tune-part').click();
  await page.keyboard.press('Space');
  await page.locator('#events li', { hasText: 'STOP: acknowledged' }).waitFor();
  await page.waitForFunction(() => !(/** @type {any} */ (window).rumbo.state().robot.armed));
  const before = await page.evaluate(() => /** @type {any} */ (window).rumbo.state().t_s);
  await page.waitForFunction((before) => /** @type {any} */ (window).rumbo.state().t_s > before + 0.5, before);
  assert.equal(await page.locator('#tune-cancel').isVisible(), true);
  await page.locator('#tune-cancel').click();
  assert.equal(await page.locator('#tune-cancel').isVisible(), false);
  assert.equal(await page.locator('#tune-result').isVisible(), false);
});

rare('it finds what rumbo tune finds, from what the robot has; the values are set and saved', async () => {
  await page.locator('#tune-dialog').getByRole('button', { name: 'Close' }).click();
  const field = page.locator('#parameter-front_kp');
  await field.fill('1');
  await field.press('Enter');
  await page.locator('#events li', { hasText: 'front_kp = 1: acknowledged' }).waitFor();
  await ask(page);
  await page.locator('#tune-parameters label', { hasText: /front_kp\s+1\s/ }).waitFor();
  await choose(page, ['front_kp', 'front_brake_m_s2']);
  await page.locator('#tune-aims').fill('settling_s');
  await page.locator('#tune-runs').fill('2000');
  await page.locator('#tune-seed').fill('7');
  await page.locator('#tune-start').click();
  await page.locator('#tune-result').waitFor();
  const file = join(folder(), 'robot.toml');
  const options = ['--for', 'settling_s', '--over', 'front_kp,front_brake_m_s2', '--param', 'front_kp=1', '--runs', '2000', '--seed', '7'];
  const found = JSON.parse(execFileSync(program(), ['tune', 'mode1', ...options, '--json', '--out', file], { stdio: ['ignore', 'pipe', 'ignore'] }).toString());
  const cells = (/** @type {number} */ table) => page.locator('#tune-result table').nth(table).locator('tbody tr').evaluateAll((rows) => rows.map((row) => [...row.children].map((cell) => cell.textContent)));
  const short = (/** @type {number} */ value) => String(Number(value.toPrecision(4)));
  assert.deepEqual((await cells(0)).map(([name, , now, tuned]) => [name, now, tuned]), found.parameters.map((/** @type {any} */ each) => [each.name, short(each.now), short(each.tuned)]));
  const passes = `on 100 robots that the search has not seen: ${found.held_out.passed_now} passed, ${found.held_out.passed_tuned} pass`;
  assert.equal(await page.locator('#tune-result p').first().textContent(), passes);
  const settling = (await cells(1)).find(([metric]) => metric === 'step1.settling_s');
  const expected = found.differences.find((/** @type {any} */ each) => each.metric === 'step1.settling_s');
  assert.deepEqual(settling?.slice(1, 3), expected.medians.map(short));
  assert.deepEqual(await violations(page, '#tune-dialog'), []);
  if (process.env['SCREENSHOT_TUNE']) {
    await page.screenshot({ path: `${process.env['SCREENSHOT_TUNE']}-result.png` });
    await page.setViewportSize({ width: 390, height: 844 });
    await page.screenshot({ path: `${process.env['SCREENSHOT_TUNE']}-narrow.png` });
    await page.setViewportSize({ width: 1280, height: 720 });
  }

  const saving = page.waitForEvent('download');
  await page.locator('#tune-save').click();
  const download = await saving;
  assert.match(download.suggestedFilename(), /^\w+-tuned\.toml$/);
  const saved = join(folder(), 'saved.toml');
  await download.saveAs(saved);
  assert.equal(readFileSync(saved, 'utf8'), readFileSync(file, 'utf8'));

  await page.locator('#tune-curves').click();
  await page.locator('#comparison tr', { hasText: 'step 1: settling' }).waitFor();
  assert.match(await page.locator('#comparison > .row').nth(1).innerText(), /1: before, seed \d+\s+2: after/);
  assert.deepEqual(await page.locator('#comparison tr', { hasText: 'front_kp' }).locator('td').allInnerTexts().then(([name, now]) => [name, now]), ['front_kp', '1']);
  if (process.env['SCREENSHOT_TUNE']) await page.screenshot({ path: `${process.env['SCREENSHOT_TUNE']}-curves.png` });
  await page.locator('#runs-dialog').getByRole('button', { name: 'Close' }).click();

  await page.locator('#tune-set').click();
  const [{ tuned }] = found.parameters;
  await eventually(async () => assert.equal(Number(await field.inputValue()), tuned));
});

rare('a page without control neither searches nor sets', async () => {
  const other = await showPage(page.context(), dashboard.url);
  await other.locator('#take-control').click();
  await page.locator('#seat-words', { hasText: 'has control, this is page' }).waitFor();
  assert.equal(await page.locator('#tune-set').isDisabled(), true);
  await page.locator('#tune-start').click();
  await complaint().getByText('another page has control; take it first').waitFor();
  await other.close();
  assert.deepEqual(dashboard.complaints, []);
});

rare('it is in Spanish, on a narrow screen too', async () => {
  const spanish = await open(['lab', '--out', folder(), '--scenario', 'mode5'], { locale: 'es-ES', viewport: { width: 390, height: 844 } });
  const { page } = spanish;
  await page.waitForSelector('#connection.good, #connection.warning');
  await page.locator('#views button[value="events"]').click();
  await page.getByRole('button', { name: 'Sintonizar' }).click();
  await page.locator('#tune-start:enabled').waitFor();
  await choose(page, ['kv']);
  await page.locator('#tune-aims').fill('rms');
  await page.locator('#tune-start').click();
  await page.locator('#tune-dialog .complaint').getByText('no hay métrica `rms`; ').waitFor();
  if (process.env['SCREENSHOT_TUNE']) await page.screenshot({ path: `${process.env['SCREENSHOT_TUNE']}-spanish.png` });
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth) <= 390);
  assert.ok(await page.locator('#tune-dialog').evaluate((dialog) => dialog.scrollWidth <= dialog.clientWidth));
  assert.deepEqual(await page.evaluate(() => /** @type {any} */ (window).rumbo.untranslated()), []);
  assert.deepEqual(spanish.complaints, []);
  await spanish.close();
});
