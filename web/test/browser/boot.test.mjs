// @ts-check
/** A page whose files do not all come at once. */
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { folder, launch, start } from '../dashboard.mjs';

test('files that did not come are asked for again, until the page is whole', async () => {
  const { server, url } = await start(['lab', '--out', folder()]);
  const context = await (await launch()).newContext();
  try {
    const page = await context.newPage();
    let lost = 0;
    for (const file of ['**/src/units.js', '**/style.css', '**/src/main.js']) {
      await page.route(file, (route) => (lost < 3 && ++lost ? route.abort() : route.fallback()));
    }
    await page.goto(url);
    await page.waitForSelector('#connection.good', { timeout: 60_000 });
    assert.ok(lost >= 2, String(lost));
    assert.equal(await page.locator('#stop').evaluate((stop) => getComputedStyle(stop).position !== 'static' || getComputedStyle(stop).fontWeight === '700'), true);
  } finally {
    await context.close();
    server.kill();
  }
});
