// @ts-check
/** What axe finds on the pages: nothing serious, in both colour schemes. */
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { join } from 'node:path';
import { test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { violations } from './axe.mjs';
import { folder, open, program } from './dashboard.mjs';

for (const colorScheme of /** @type {const} */ (['dark', 'light'])) {
  test(`dashboard, first steps, recordings and replay, ${colorScheme}`, async () => {
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
        assert.deepEqual(await violations(page), [], name);
      }
      await page.getByRole('tab', { name: 'Events' }).click();
      await page.locator('#edit-world').click();
      await page.locator('#editor').waitFor();
      assert.deepEqual(await violations(page), [], 'world editor');
      await page.locator('#edit-world').click();
      await page.locator('#help').click();
      assert.deepEqual(await violations(page), [], 'help');
      await page.keyboard.press('Escape');
      await page.locator('#recordings').click();
      await page.locator('.recordings td').first().waitFor();
      assert.deepEqual(await violations(page), [], 'recordings');
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

test('the report', async () => {
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
