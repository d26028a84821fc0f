// @ts-check
/** The first minute, and panels that are enlarged. */
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { folder, open } from '../dashboard.mjs';

/** @param {Awaited<ReturnType<typeof open>>['page']} page @param {string} words */
const step = (page, words) => page.locator('#tour .hint', { hasText: words }).waitFor();

test('the first steps go on with what is done, end, and come again only when asked for', async () => {
  const dashboard = await open(['lab', '--out', folder()], {}, true);
  try {
    const { page } = dashboard;
    await step(page, 'step 1 of 4');
    await page.locator('#map-section.pointed').waitFor();
    await page.locator('#tour').getByRole('button', { name: 'Next' }).click();
    await page.locator('#on.pointed').click();
    await step(page, 'step 3 of 4');
    await page.locator('#reference-cm').fill('45');
    await page.locator('#reference-cm').press('Enter');
    await step(page, 'step 4 of 4');
    await page.locator('#tour').getByRole('button', { name: 'Done' }).click();
    await page.locator('#tour').waitFor({ state: 'hidden' });
    assert.equal(await page.locator('.pointed').count(), 0);
    await page.reload();
    await page.waitForSelector('#connection.good');
    await page.locator('#parameters input').first().waitFor();
    assert.equal(await page.locator('#tour').isVisible(), false, 'once');
    await page.locator('#help').click();
    await page.locator('#tour-again').click();
    await step(page, 'step 1 of 4');
    await page.locator('#tour').getByRole('button', { name: 'Skip' }).click();
    await page.locator('#tour').waitFor({ state: 'hidden' });
    assert.deepEqual(dashboard.complaints, []);
  } finally {
    await dashboard.close();
  }
});

for (const [width, height] of [[1280, 800], [390, 844], [640, 360]]) {
  test(`the first steps hide neither STOP nor what they are about, in Spanish, ${width} x ${height}`, async () => {
    const dashboard = await open(['lab', '--out', folder()], { viewport: { width: width ?? 0, height: height ?? 0 }, locale: 'es-ES' }, true);
    try {
      const { page } = dashboard;
      for (let number = 1; number <= 4; number++) {
        await step(page, `paso ${number} de 4`);
        const seen = await page.evaluate(() => ['#tour', '#stop', '.pointed'].map((name) => {
          const { left, right, top, bottom } = document.querySelector(name)?.getBoundingClientRect() ?? new DOMRect();
          return { left, right, top, bottom };
        }));
        const [card, stop, about] = seen;
        assert.ok(card && stop && about && card.left >= 0 && card.right <= (width ?? 0) && card.bottom <= (height ?? 0), JSON.stringify(seen));
        // On a telephone it is below.
        assert.ok((stop.bottom <= card.top || stop.top >= card.bottom) && stop.top >= 0 && stop.bottom <= (height ?? 0), `STOP: ${JSON.stringify(seen)}`);
        assert.ok((about.top < card.top - 20 || about.top >= card.bottom) && about.bottom > 0, `step ${number}: ${JSON.stringify(seen)}`);
        await page.locator('#tour .go').click();
      }
      assert.deepEqual(await page.evaluate(() => /** @type {any} */ (window).rumbo.untranslated()), []);
    } finally {
      await dashboard.close();
    }
  });
}

test('every panel is enlarged to the page and put back, by its button and by Escape, and STOP stays', async () => {
  const dashboard = await open(['lab', '--out', folder()], { viewport: { width: 1280, height: 800 } });
  try {
    const { page } = dashboard;
    await page.waitForSelector('#connection.good');
    const before = await page.locator('#map-section').boundingBox();
    for (const id of ['map-section', 'command-section', 'plot-section', 'console-section', 'parameter-section', 'event-section']) {
      const panel = page.locator(`#${id}`);
      if (!(await panel.isVisible())) continue;
      await panel.locator('.enlarge').click();
      const box = await panel.boundingBox();
      assert.ok(box && box.width > 1200 && box.height > 650, `${id}: ${JSON.stringify(box)}`);
      assert.equal(await page.locator('main > section:visible').count(), 1, id);
      assert.ok(await page.locator('#stop').isVisible());
      if (id === 'map-section') await page.keyboard.press('Escape');
      else await panel.locator('.enlarge').click();
      assert.ok(await page.locator('main > section:visible').count() > 3, id);
    }
    assert.deepEqual(await page.locator('#map-section').boundingBox(), before);
    assert.deepEqual(dashboard.complaints, []);
  } finally {
    await dashboard.close();
  }
});
