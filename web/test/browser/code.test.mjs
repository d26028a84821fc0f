// @ts-check
/**
 * The code pane: a sketch is changed, its error stands in its line and in the list, mended it runs, and what was typed outlasts the
 * page. The debugger: a breakpoint, a step, a step back, variables; the robot's time stands, and STOP works.
 */
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { eventually, folder, open } from '../dashboard.mjs';

const works = ['avr-gcc --version', 'bwrap --ro-bind / / true'].every((command) => spawnSync('sh', ['-c', command]).status === 0);
const skip = works ? false : 'avr-gcc or bwrap is missing';
if (skip && process.env['CI']) throw new Error(skip);

const SKETCH = `int count = 0, calls = 0;
int doubled(int x) {
  calls = calls + 1;
  return 2 * x; }
void setup() { Serial.begin(115200); }
void loop() {
  count = count + 1;
  int twice = doubled(count);
  delay(20);
  Serial.println(twice);
}
`;

/** @type {Awaited<ReturnType<typeof open>>} */
let dashboard;
/** @type {import('playwright-core').Page} */
let page;

before(async () => {
  if (skip) return;
  const sketch = join(folder(), 'counter');
  mkdirSync(sketch);
  writeFileSync(join(sketch, 'counter.ino'), SKETCH);
  dashboard = await open(['lab', '--scenario', 'mode1', '--sketch', sketch, '--out', folder()], { viewport: { width: 1280, height: 800 } });
  page = dashboard.page;
  await page.waitForSelector('body.own');
});

after(() => dashboard?.close());

const lines = () => page.locator('#code-editor .cm-line');
const press = (/** @type {string} */ value) => page.locator(`#debug-panel [value="${value}"]`).click();
const stands = (/** @type {string} */ text) => page.locator('#code-editor .stands', { hasText: text }).waitFor();
/** A variable as it is shown. @param {string} name */
const variable = (name) => page.locator('#debug-scopes p', { has: page.locator(`b:text-is("${name}")`) }).locator('output').first().textContent();
const now_s = () => page.evaluate(() => /** @type {any} */ (window).rumbo.state().program.held.t_us / 1e6);

/** Types at the end of a line. @param {string} line @param {string} text */
async function type(line, text) {
  await lines().filter({ hasText: line }).click();
  await page.keyboard.press('End');
  await page.keyboard.type(text);
}

test('what is typed is compiled, an error is shown in its line and listed, and mended it runs', { skip }, async () => {
  await page.locator('#code-open').click();
  await lines().filter({ hasText: 'int doubled' }).waitFor();
  await type('Serial.println', ' sped = 3;');
  assert.match(await page.locator('#code-note').textContent() ?? '', /kept in this browser/);
  await page.locator('#code-run').click();
  await page.locator('#complaints li', { hasText: /counter\.ino:10:.*sped.*not declared/ }).waitFor();
  assert.match(await page.locator('#code-editor .cm-lintRange-error').textContent() ?? '', /sped/);
  await lines().filter({ hasText: 'void setup' }).click();
  await page.locator('#complaints button').first().click();
  // Where the error is, a space is a space, and no STOP.
  await page.keyboard.press('Home');
  await page.keyboard.type('int sped = 1; Serial.print("typed ");');
  await page.keyboard.press('Control+Enter');
  await page.locator('#console').filter({ hasText: /typed \d+/ }).waitFor();
  assert.equal(await page.locator('#code-editor .cm-lintRange-error').count(), 0);
  assert.equal(await page.locator('#armed').textContent(), 'motors supplied');
});

test('it is still there when the page is loaded again, until it is discarded', { skip }, async () => {
  await eventually(async () => assert.match(await page.evaluate(() => localStorage.getItem('rumbo.sketch.counter')) ?? '', /typed/));
  await page.reload();
  await page.locator('#code-open').click();
  await lines().filter({ hasText: 'int sped = 1' }).waitFor();
});

test('it stops at a breakpoint, steps, and steps back to the values that were; time stands, and STOP works', { skip }, async () => {
  await page.locator('#code-editor .cm-lineNumbers .cm-gutterElement').getByText('8', { exact: true }).click();
  await page.locator('#code-debug').click();
  await stands('doubled(count)');
  // Longer than a station may be silent.
  await page.waitForTimeout(2_100);
  assert.ok(!(await page.locator('body').evaluate((body) => body.classList.contains('stale'))), 'nothing shown is old');
  assert.equal(await variable('count'), '1');
  await lines().filter({ hasText: 'count = count + 1' }).hover({ position: { x: 36, y: 8 } });
  await page.locator('#code-editor .value', { hasText: 'count = 1' }).waitFor();
  // Again from the start.
  await press('continue');
  await eventually(async () => assert.equal(await variable('count'), '2'));
  await page.locator('#code-debug').click();
  await eventually(async () => assert.equal(await variable('count'), '1'));
  const begun_s = await now_s();
  await press('stepIn');
  await stands('calls = calls + 1');
  await eventually(async () => assert.deepEqual(await page.locator('#debug-stack .link').allTextContents().then((all) => all.slice(0, 2)), ['doubled', 'loop']));
  await press('stepOut');
  await stands('doubled(count)');
  await press('next');
  await stands('delay(20)');
  await press('next');
  await stands('Serial.println');
  const later_s = await eventually(async () => {
    const later_s = await now_s();
    assert.ok(later_s > begun_s + 0.019, `${begun_s} ${later_s}`);
    return later_s;
  });
  await press('stepBack');
  await stands('delay(20)');
  await page.locator('#debug-words', { hasText: 'in the past' }).waitFor();
  assert.ok(await now_s() < later_s - 0.019);
  await press('continue');
  await eventually(async () => assert.equal(await variable('count'), '2'));
  await press('stepBack');
  await stands('count = count + 1');
  await eventually(async () => assert.equal(await variable('count'), '1'));
  await page.locator('#stop').click();
  await page.locator('#armed', { hasText: 'motors without supply' }).waitFor();
  await press('disconnect');
  await page.locator('#debug-panel').waitFor({ state: 'hidden' });
  assert.deepEqual(dashboard.complaints, []);
  assert.deepEqual(await page.evaluate(() => /** @type {any} */ (window).rumbo.untranslated()), []);
});

test('a sketch of this computer is opened, and Run drives with it', { skip }, async () => {
  await page.locator('#code-section input[type=file]').setInputFiles([
    { name: 'own one.ino', mimeType: 'text/plain', buffer: Buffer.from('#include "words.h"\nvoid setup() { Serial.begin(115200); }\nvoid loop() { Serial.println(WORDS); delay(50); }\n') },
    { name: 'words.h', mimeType: 'text/plain', buffer: Buffer.from('#define WORDS "my own words"\n') },
  ]);
  await page.locator('#code-tabs button', { hasText: 'words.h' }).waitFor();
  assert.match(await page.locator('#code-note').textContent() ?? '', /own one\.ino is here/);
  await page.locator('#code-run').click();
  await page.locator('#console').filter({ hasText: 'my own words' }).waitFor();
});
