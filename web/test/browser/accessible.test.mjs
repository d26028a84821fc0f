// @ts-check
/** What axe finds on the pages: nothing, in both colour schemes. */
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import { mkdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { violations } from '../axe.mjs';
import { folder, launch, open, program, rare } from '../dashboard.mjs';

// Contrast in the other scheme: `contrast.test.mjs`.
for (const [colorScheme, driven] of /** @type {const} */ ([['dark', test], ['light', rare]])) {
  driven(`dashboard, first steps, recordings and replay, ${colorScheme}`, async () => {
    const out = folder();
    execFileSync(program(), ['run', 'mode1', '--seed', '1', '--out', out], { stdio: 'ignore' });
    const dashboard = await open(['lab', '--out', out], { colorScheme, viewport: { width: 1280, height: 800 } }, true);
    try {
      const { page } = dashboard;
      await page.waitForSelector('#connection.good');
      await page.locator('#parameters input').first().waitFor();
      await page.locator('#tour').waitFor();
      assert.deepEqual(await violations(page), [], 'first steps');
      await page.getByRole('button', { name: 'Skip' }).click();
      await page.locator('#on').click();
      for (const name of ['Events', 'States', 'Link', 'Bytes']) {
        await page.getByRole('tab', { name }).click();
        assert.deepEqual(await violations(page, '#event-section'), [], name);
      }
      await page.getByRole('tab', { name: 'Events' }).click();
      await page.locator('#edit-world').click();
      await page.locator('#editor').waitFor();
      assert.deepEqual(await violations(page, '#editor'), [], 'world editor');
      await page.locator('#edit-world').click();
      await page.locator('#code-open').click();
      await page.locator('#code-editor .cm-line').first().waitFor();
      assert.deepEqual(await violations(page, '#code-section'), [], 'code');
      await page.locator('#code-open').click();
      await page.locator('#help').click();
      assert.deepEqual(await violations(page, '#help-dialog'), [], 'help');
      await page.keyboard.press('Escape');
      await page.locator('#recordings').click();
      await page.locator('.recordings td').first().waitFor();
      assert.deepEqual(await violations(page, '#recordings-dialog'), [], 'recordings');
    } finally {
      await dashboard.close();
    }
    const replay = await open(['replay', join(out, 'mode1-1.mcap')], { colorScheme });
    try {
      await replay.page.locator('#parameters input').first().waitFor();
      assert.deepEqual(await violations(replay.page), [], 'replay');
    } finally {
      await replay.close();
    }
  });
}

rare('the report, a sweep and a class', async () => {
  const out = folder();
  const hands = join(out, 'hands');
  for (const [name, text] of [['Ana', 'void setup() { pinMode(5, OUTPUT); digitalWrite(5, HIGH); }\nvoid loop() {}\n'], ['Zoe', 'void setup() {}\nvoid loop() {}\n']]) {
    mkdirSync(join(hands, name ?? ''), { recursive: true });
    writeFileSync(join(hands, name ?? '', 'x.ino'), text ?? '');
  }
  const compiled = spawnSync('avr-gcc', ['--version']).status === 0;
  const assignment = fileURLToPath(new URL('../../../examples/assignments/wall/assignment.toml', import.meta.url));
  const run = (/** @type {string[]} */ ...words) => spawnSync(program(), words, { stdio: 'ignore' });
  run('experiments', '--only', 'mode1', '--out', out);
  run('sweep', 'mode1', 'front_kp=1:6:3', '--out', join(out, 'sweep'));
  if (compiled) run('grade', assignment, hands, '--trust', '--out', join(out, 'class'));
  const pages = ['report.html', 'sweep/index.html', ...(compiled ? ['class/index.html', 'class/students/Zoe.html'] : [])];
  const page = await (await launch()).newPage();
  for (const colorScheme of /** @type {const} */ (['dark', 'light'])) {
    await page.emulateMedia({ colorScheme });
    for (const width of [1280, 390]) {
      await page.setViewportSize({ width, height: 800 });
      for (const name of pages) {
        await page.goto(pathToFileURL(join(out, name)).href);
        assert.deepEqual(await violations(page), [], `${name} ${width} ${colorScheme}`);
      }
    }
  }
  await page.close();
});
