// @ts-check
/** The recordings: find one, open it, compare some, delete one. SCREENSHOT_RECORDINGS is a file for a picture. */
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { existsSync, readdirSync, symlinkSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { eventually, folder, open, program, showPage } from '../dashboard.mjs';

const out = folder();
/** @type {Awaited<ReturnType<typeof open>>} */
let dashboard;
/** @type {import('playwright-core').Page} */
let page;

before(async () => {
  for (const [scenario, seed] of [['mode1', '3'], ['mode1', '4'], ['mode5', '1']]) spawnSync(program(), ['run', scenario ?? '', '--seed', seed ?? '', '--out', out]);
  writeFileSync(join(out, 'notes.mcap'), 'not a log');
  dashboard = await open(['lab', '--out', out]);
  page = dashboard.page;
  await page.waitForSelector('#connection.good');
});

after(() => dashboard?.close());

/** @param {string} name */
const row = (name) => page.locator(`.recordings tr[title="${name}"]`);

/** A request with the page's key. @param {string} path @param {string} method */
const ask = (path, method) => page.evaluate(async ({ path, method }) => {
  const answer = await fetch(path, { method, headers: { Authorization: `Bearer ${localStorage.getItem('rumbo.key')}` } });
  return { status: answer.status, text: await answer.text() };
}, { path, method });

test('all recordings of the folder are listed, with what they are, and found by words', async () => {
  await page.locator('#recordings').click();
  await row('mode1-3').waitFor();
  await eventually(async () => assert.equal(await page.locator('.recordings tbody tr').count(), 5, 'four files and the one that is being recorded'));
  assert.match(await row('mode1-3').innerText(), /Stop at a distance from a wall, 107 → 30 → 50 cm/);
  assert.match(await row('notes').innerText(), /not readable/);
  await page.locator('#recordings-find').fill('wheel speeds');
  await row('mode5-1').waitFor();
  await eventually(async () => assert.equal(await page.locator('.recordings tbody tr').count(), 1));
  await page.locator('#recordings-find').fill('');
});

test('two are compared: a signal of both, their metrics, the difference', async () => {
  await row('mode1-3').getByRole('checkbox').check();
  await row('mode1-4').getByRole('button', { name: 'Compare' }).click();
  await page.locator('#comparison .u-wrap').waitFor();
  const settling = await page.locator('#comparison tr', { hasText: 'step1.settling_s' }).locator('td').allInnerTexts();
  const [one, other, difference] = settling.slice(1).map((text) => Number(text.replace('−', '-')));
  assert.ok(one && other && one > 1 && Math.abs(other - one - (difference ?? NaN)) < 0.011, settling.join());
  await page.locator('#compare-signal').selectOption('left_rpm');
  if (process.env['SCREENSHOT_RECORDINGS']) await page.screenshot({ path: process.env['SCREENSHOT_RECORDINGS'] });
  await page.locator('#runs-dialog').getByRole('button', { name: 'Close' }).click();
  await page.locator('#recordings').click();
});

test('one opens as a replay in a page of its own, beside the lab', async () => {
  const [replay] = await Promise.all([page.context().waitForEvent('page'), row('mode1-3').getByRole('button', { name: 'Open' }).click()]);
  await replay.locator('#replay-name', { hasText: 'mode1-3' }).waitFor();
  assert.equal(await replay.locator('#recordings').isVisible(), false);
  assert.equal(await page.locator('#stop').isVisible(), true, 'the lab goes on');
  await replay.close();
});

test('the one that is being recorded has no way to be deleted', async () => {
  const current = page.locator('.recordings tr', { hasText: 'being recorded' });
  assert.equal(await current.count(), 1);
  assert.equal(await current.getByRole('button', { name: 'Delete' }).count(), 0);
  const name = await current.getAttribute('title') ?? '';
  const answer = await ask(`/recordings/${name}?page=1`, 'DELETE');
  assert.deepEqual([answer.status, existsSync(join(out, `${name}.mcap`))], [409, true]);
  assert.match(answer.text, /being recorded/);
});

test('a name that is none of the folder deletes nothing, whatever it looks like', async () => {
  const outside = join(folder(), 'other.mcap');
  spawnSync(program(), ['run', 'mode5', '--seed', '1', '--out', outside.replace(/\/other\.mcap$/, '')]);
  writeFileSync(outside, 'x');
  symlinkSync(outside, join(out, 'link.mcap'));
  for (const name of ['../other', '..%2Fother', encodeURIComponent(outside.replace('.mcap', '')), 'link', 'mode1-3.mcap', '.', '%00']) {
    const { status } = await ask(`/recordings/${name}?page=1`, 'DELETE');
    assert.ok(status >= 400, `${name}: ${status}`);
  }
  assert.ok(existsSync(outside) && existsSync(join(out, 'link.mcap')));
  assert.equal((await ask('/recordings/notes?page=1', 'DELETE')).status, 409, 'no log of Rumbo');
  for (const asking of ['', '?page=99', '?page=x']) assert.ok((await ask(`/recordings/mode5-1${asking}`, 'DELETE')).status === 403, asking);
  assert.ok(existsSync(join(out, 'mode5-1.mcap')));
});

test('a page without control deletes nothing', async () => {
  const other = await showPage(page.context(), dashboard.url.replace(/\?.*/, ''));
  await other.locator('#off').click();
  await page.locator('#seat-words', { hasText: /page 2 has control/ }).waitFor();
  await row('mode5-1').getByRole('button', { name: 'Delete' }).click();
  await row('mode5-1').getByRole('button', { name: 'Delete for good' }).click();
  await page.locator('#recordings-dialog .complaint', { hasText: 'another page has control' }).waitFor();
  assert.ok(existsSync(join(out, 'mode5-1.mcap')));
  await other.close();
});

test('one is deleted, after a question', async () => {
  await page.locator('#seat').waitFor({ state: 'hidden' });
  await page.locator('#recordings-dialog').getByRole('button', { name: 'Close' }).click();
  await page.locator('#recordings').click();
  await row('mode5-1').getByRole('button', { name: 'Delete' }).click();
  await row('mode5-1').getByRole('button', { name: 'Keep' }).click();
  assert.ok(existsSync(join(out, 'mode5-1.mcap')));
  await row('mode5-1').getByRole('button', { name: 'Delete' }).click();
  await row('mode5-1').getByRole('button', { name: 'Delete for good' }).click();
  await row('mode5-1').waitFor({ state: 'detached' });
  assert.ok(!existsSync(join(out, 'mode5-1.mcap')) && readdirSync(out).includes('mode1-3.mcap'));
});

test('without a key nothing is listed', async () => {
  const status = await page.evaluate(async () => (await fetch('/recordings')).status);
  assert.equal(status, 403);
  // The browser itself complains of each refusal.
  assert.deepEqual(dashboard.complaints.filter((each) => !each.includes('Failed to load resource')), []);
});
