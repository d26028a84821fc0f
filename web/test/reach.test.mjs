// @ts-check
/** The page fits and can be used without a pointer: sizes of screens, names, the order of Tab. */
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { folder, open } from './dashboard.mjs';

/** @type {Awaited<ReturnType<typeof open>>} */
let dashboard;
/** @type {import('playwright-core').Page} */
let page;

before(async () => {
  dashboard = await open(['lab', '--scenario', 'mode8-goals', '--out', folder()]);
  page = dashboard.page;
  await page.waitForSelector('#connection.good');
});

after(() => dashboard?.close());

/** How far the page is wider and higher than its window [px]. */
const beyond = () => page.evaluate(() => {
  const all = document.scrollingElement ?? document.body;
  return [all.scrollWidth - innerWidth, all.scrollHeight - innerHeight];
});

/** The parts whose contents they do not hold, and which do not scroll. */
const cutOff = () => page.evaluate(() => ['top', 'command-section', 'plot-section', 'event-section', 'parameter-section'].filter((id) => {
  const part = document.getElementById(id);
  return part && (part.scrollHeight > part.clientHeight + 1 || part.scrollWidth > part.clientWidth + 1);
}));

test('1280 x 720 holds everything without scrolling, and every mode, in both languages', async () => {
  for (const language of ['en', 'es']) {
    await page.locator('#language').selectOption(language);
    await page.waitForFunction((language) => document.documentElement.lang === language && /** @type {any} */ (window).rumbo?.state(), language);
    for (const mode of [0, 5, 7, 8]) {
      await page.locator(`#modes button[value="${mode}"]`).click();
      await page.locator(`#modes button[value="${mode}"][aria-pressed="true"]`).waitFor();
      assert.deepEqual(await beyond(), [0, 0], `${language}, mode ${mode}`);
      assert.deepEqual(await cutOff(), [], `${language}, mode ${mode}`);
    }
  }
  await page.locator('#language').selectOption('en');
  await page.waitForFunction(() => document.documentElement.lang === 'en' && /** @type {any} */ (window).rumbo?.state());
});

test('on a tablet nothing is cut off at the sides, and STOP stays in sight', async () => {
  for (const [width, height] of /** @type {[number, number][]} */ ([[1024, 768], [768, 1024]])) {
    await page.setViewportSize({ width, height });
    assert.equal((await beyond())[0], 0, `${width} x ${height}`);
    await page.evaluate(() => scrollTo(0, 10_000));
    const box = await page.locator('#stop').boundingBox();
    assert.ok(box && box.y >= 0 && box.y + box.height < 130 && box.x > width / 2, `${width}: ${JSON.stringify(box)}`);
    await page.evaluate(() => scrollTo(0, 0));
  }
  await page.setViewportSize({ width: 1280, height: 720 });
});

test('everything that can be used has a name', async () => {
  const nameless = await page.evaluate(() => [...document.querySelectorAll('button, input, select, [tabindex], [role="tab"]')].filter((each) => {
    const named = each.getAttribute('aria-label') || each.getAttribute('title') || each.textContent?.trim() || each.closest('label')?.textContent?.trim() || each.getAttribute('aria-labelledby');
    return !named && !(each instanceof HTMLInputElement && each.hidden);
  }).map((each) => each.outerHTML.slice(0, 80)));
  assert.deepEqual(nameless, []);
});

test('Tab reaches every part of the page and shows where it is', async () => {
  await page.locator('#language').focus();
  const seen = new Set();
  for (let step = 0; step < 160; step++) {
    const at = await page.evaluate(() => {
      const focused = document.activeElement;
      const outline = focused ? getComputedStyle(focused).outlineStyle : '';
      return { part: focused?.closest('section')?.id ?? focused?.closest('header')?.tagName ?? '', id: focused?.id ?? '', outline };
    });
    if (at.part) {
      seen.add(at.part);
      seen.add(at.id);
      assert.notEqual(at.outline, 'none', `no outline at ${at.part} ${at.id}`);
    }
    if (seen.has('event-section') && at.part !== 'event-section') break;
    await page.keyboard.press('Tab');
  }
  for (const part of ['HEADER', 'stop', 'map', 'on', 'plots', 'plot-section', 'command-section', 'parameter-section', 'event-section', 'checkup']) assert.ok(seen.has(part), `${part} is not reached`);
  assert.deepEqual(dashboard.complaints, []);
});
