// @ts-check
/** What axe finds on the pages: nothing serious, in both colour schemes. */
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { join } from 'node:path';
import { test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { violations } from '../axe.mjs';
import { folder, open, program, rare } from '../dashboard.mjs';

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

rare('the report', async () => {
  const out = folder();
  execFileSync(program(), ['experiments', '--only', 'mode1', '--out', out], { stdio: 'ignore' });
  const dashboard = await open(['lab', '--out', out]);
  try {
    const { page } = dashboard;
    for (const colorScheme of /** @type {const} */ (['dark', 'light'])) {
      await page.emulateMedia({ colorScheme });
      await page.goto(pathToFileURL(join(out, 'report.html')).href);
      assert.deepEqual(await violations(page), [], colorScheme);
    }
  } finally {
    await dashboard.close();
  }
});
