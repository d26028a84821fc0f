// @ts-check
/** A lesson beside the lab, worked through and handed in. */
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { violations } from '../axe.mjs';
import { eventually, folder, open } from '../dashboard.mjs';

test('a lesson takes the figures of its runs, compares them, and is saved to hand in', async () => {
  const dashboard = await open(['lab', '--speed', '4', '--out', folder()], { viewport: { width: 1280, height: 800 } });
  const { page } = dashboard;
  try {
    await page.waitForSelector('#connection.good');
    await page.locator('#lessons').click();
    await page.locator('#lesson-body button', { hasText: 'Stopping before a wall' }).click();
    const row = page.locator('#lesson-body tr', { has: page.locator('input') });
    const state = () => page.evaluate(() => /** @type {any} */ (window).rumbo.state());
    await row.nth(2).locator('button').click();
    await eventually(async () => assert.equal(await page.locator('#parameter-front_brake_m_s2').inputValue(), '0.8'));
    await page.locator('#on').click();
    const cells = row.nth(2).locator('input');
    await eventually(async () => assert.match(await cells.nth(1).inputValue(), /^\d/, JSON.stringify((await state()).robot.task.end)));
    assert.ok(Number(await cells.nth(0).inputValue()) > 4, 'it overshoots');
    // What a person writes is no STOP and no key of the page.
    await row.nth(1).locator('input').nth(1).fill('9');
    await page.locator('#hand-in-answers').pressSequentially('It slides past, l');
    assert.equal((await state()).robot.armed, true);
    // Another lesson is looked at, and the page loaded again: what was written is there.
    await page.locator('#lesson-list').click();
    await page.reload();
    await page.locator('#lessons').click();
    await page.locator('#lesson-body button', { hasText: 'Stopping before a wall' }).click();
    await page.locator('#hand-in-check').click();
    await page.locator('#hand-in output', { hasText: /^\d agree, [1-3] do not, 7 are empty$/ }).waitFor();
    assert.deepEqual(await violations(page, '#lesson'), []);
    const [saved] = await Promise.all([page.waitForEvent('download'), page.locator('#hand-in-save').click()]);
    const text = readFileSync(await saved.path(), 'utf8');
    assert.match(text, /^# 2\. Stopping before a wall\n/);
    assert.match(text, /\| brakes late, a = 0\.8 \| [\d.]+ \| [\d.]+ \| `scenario=mode1&seed=1&front_brake_m_s2=0\.8` \|/);
    assert.match(text, /It slides past, l\n$/);
    assert.deepEqual(dashboard.complaints, []);
  } finally {
    await dashboard.close();
  }
});
