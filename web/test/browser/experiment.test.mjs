// @ts-check
/** *Run the experiment*: the scenario's commands at their times, and the verdict of the command line. */
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readdirSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { violations } from '../axe.mjs';
import { folder, open, program, rare } from '../dashboard.mjs';

test('the experiment is run, and its verdict has the numbers of rumbo run; the session runs again byte for byte', async () => {
  const out = folder();
  const dashboard = await open(['lab', '--scenario', 'mode1', '--out', out], { viewport: { width: 1280, height: 800 } });
  const { page } = dashboard;
  const verdict = page.locator('#experiment-words');
  try {
    await page.waitForSelector('#connection.good');
    await page.locator('#speed').selectOption('8');
    await page.locator('#play').click();
    await verdict.filter({ hasText: / of 9 s/ }).waitFor();
    await page.locator('#reference button').click();
    await page.locator('#events li', { hasText: 'refused, the experiment runs; STOP ends it' }).waitFor();
    await verdict.filter({ hasText: 'passed: 7 of 7 limits kept' }).waitFor();
    const { metrics } = JSON.parse(execFileSync(program(), ['run', 'mode1', '--seed', '1', '--json'], { encoding: 'utf8' }));
    await page.locator('#experiment-details').click();
    const rows = await page.locator('#experiment-dialog tbody tr').evaluateAll((rows) => rows.map((row) => [...row.querySelectorAll('td')].map(({ textContent }) => textContent ?? '')));
    assert.equal(rows.length, 7);
    for (const [name = '', value] of rows) assert.equal(Number(value), Number(metrics[name].toPrecision(4)), name);
    assert.deepEqual(await violations(page), []);
    assert.deepEqual(await page.evaluate(() => /** @type {any} */ (window).rumbo.figures().length), 2);
    assert.deepEqual(dashboard.complaints, []);
    // Its recording ends with the next run.
    await page.keyboard.press('Escape');
    await page.locator('#simulation button[type="submit"]').click();
    await page.locator('#events li', { hasText: 'reset: mode1' }).waitFor();
    const played = readdirSync(out).filter((name) => name.endsWith('.mcap')).sort()[1] ?? '';
    assert.match(execFileSync(program(), ['rerun', join(out, played)], { encoding: 'utf8' }), /: equal, \d{3,} bytes/);
  } finally {
    await dashboard.close();
  }
});

rare('changed parameters are part of the experiment, and STOP ends it without a verdict', async () => {
  const dashboard = await open(['lab', '--scenario', 'mode1', '--out', folder()]);
  const { page } = dashboard;
  try {
    const field = page.locator('#parameters tr', { hasText: 'front_kp' }).first().locator('input');
    await field.fill('1');
    await page.keyboard.press('Enter');
    await page.locator('#events li', { hasText: 'front_kp = 1: acknowledged' }).waitFor();
    await page.locator('#play').click();
    await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state().experiment?.parameters?.length === 1);
    assert.equal(await field.inputValue(), '1');
    await page.locator('#armed', { hasText: 'armed' }).waitFor();
    await page.keyboard.press('Space');
    await page.locator('#experiment-words', { hasText: 'stopped, no verdict' }).waitFor();
    await page.locator('#armed', { hasText: 'off' }).waitFor();
  } finally {
    await dashboard.close();
  }
});
