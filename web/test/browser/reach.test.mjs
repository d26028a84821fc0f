// @ts-check
/** The page fits and can be used without a pointer: sizes of screens, names, the order of Tab. */
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { PATIENCE_MS, eventually, folder, open, rare } from '../dashboard.mjs';

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
const cutOff = () => page.evaluate(() => ['top', 'command-section', 'controls', 'plot-section', 'event-section', 'parameter-section'].filter((id) => {
  const part = document.getElementById(id);
  return part && (part.scrollHeight > part.clientHeight + 1 || part.scrollWidth > part.clientWidth + 1);
}));

/** Nothing is cut off, once all is laid out: polled until true, with an error otherwise. @param {string} where */
async function fits(where) {
  const end = Date.now() + PATIENCE_MS;
  while ((await cutOff()).length > 0 && Date.now() < end) await page.evaluate(() => new Promise(requestAnimationFrame));
  assert.deepEqual(await cutOff(), [], where);
}

/** What is under something else, or out of sight, wherever the page is scrolled to. @param {string[]} selectors */
const covered = (...selectors) => page.evaluate((selectors) => selectors.flatMap((selector) => [...document.querySelectorAll(selector)].filter((each) => {
  each.scrollIntoView({ block: 'nearest' });
  const { left, top, right, bottom } = each.getBoundingClientRect();
  return right > left && ![left + 3, right - 3].every((x) => each.contains(document.elementFromPoint(x, (top + bottom) / 2)));
}).map((each) => each.id || each.textContent)), selectors);

test('1280 x 720 holds everything without scrolling, and every mode, in both languages', async () => {
  for (const language of ['en', 'es']) {
    await page.locator('#language').selectOption(language);
    await page.waitForFunction((language) => document.documentElement.lang === language && /** @type {any} */ (window).rumbo?.state(), language);
    for (const mode of [0, 5, 7, 8]) {
      await page.locator(`#modes button[value="${mode}"]`).click();
      await page.locator(`#modes button[value="${mode}"][aria-pressed="true"]`).waitFor();
      assert.deepEqual(await beyond(), [0, 0], `${language}, mode ${mode}`);
      await fits(`${language}, mode ${mode}`);
    }
    // A slow computer's rate is the longest chip; what is below the header stays under the pointer.
    const moved = await page.evaluate((text) => {
      const [chip, header] = [document.querySelector('#connection'), document.querySelector('header')];
      const before = header?.clientHeight;
      if (chip) chip.textContent = text;
      return [before, header?.clientHeight];
    }, { en: 'live 25 Hz, only × 0.94', es: 'en vivo 25 Hz, solo × 0,94' }[language] ?? '');
    assert.equal(moved[0], moved[1], `${language}: height of the header [px]`);
    // A laptop zoomed to 150 %, and a projector with a lesson.
    await page.setViewportSize({ width: 960, height: 600 });
    assert.deepEqual(await covered('#state', '#map-corner button'), [], language);
    await page.setViewportSize({ width: 1024, height: 768 });
    await page.locator('#lessons').click();
    assert.deepEqual(await covered('#lesson-close', '#state', '#map-corner button', '#layouts', '#keep-run'), [], language);
    await page.locator('#lesson-close').click();
    await page.setViewportSize({ width: 1280, height: 720 });
  }
  await page.locator('#language').selectOption('en');
  await page.waitForFunction(() => document.documentElement.lang === 'en' && /** @type {any} */ (window).rumbo?.state());
});

rare('on a tablet nothing is cut off at the sides, and STOP stays in sight', async () => {
  for (const [width, height] of /** @type {[number, number][]} */ ([[1024, 768], [768, 1024]])) {
    await page.setViewportSize({ width, height });
    assert.equal((await beyond())[0], 0, `${width} x ${height}`);
    await page.evaluate(() => scrollTo(0, 10_000));
    const box = await page.locator('#stop').boundingBox();
    assert.ok(box && box.y >= 0 && box.y + box.height < 130 && box.x > width / 2, `${width}: ${JSON.stringify(box)}`);
    await page.evaluate(() => scrollTo(0, 0));
    for (const mode of [0, 5, 7, 8]) {
      await page.locator(`#modes button[value="${mode}"]`).click();
      await page.locator(`#modes button[value="${mode}"][aria-pressed="true"]`).waitFor();
      await fits(`${width} x ${height}, mode ${mode}`);
    }
  }
  await page.setViewportSize({ width: 1280, height: 720 });
});

test('on a telephone, upright and held across, STOP stays in sight wherever the page is scrolled to', async () => {
  for (const [width, height] of /** @type {[number, number][]} */ ([[390, 844], [640, 360]])) {
    await page.setViewportSize({ width, height });
    assert.equal((await beyond())[0], 0, `${width} x ${height}`);
    for (const y of [0, 300, 10_000]) {
      await page.evaluate((y) => scrollTo(0, y), y);
      const seen = await page.locator('#stop').evaluate((stop) => {
        const { left, top, width, height } = stop.getBoundingClientRect();
        return stop.contains(document.elementFromPoint(left + width / 2, top + height / 2));
      });
      assert.ok(seen, `${width} x ${height}, scrolled to ${y}`);
    }
    await page.evaluate(() => scrollTo(0, 0));
  }
  await page.setViewportSize({ width: 1280, height: 720 });
});

/** Where a place 1 m ahead is on the map [px]; how many pixels a metre has. */
const metre_px = () => page.evaluate(() => {
  const { onMap } = /** @type {any} */ (window).rumbo;
  return Math.abs(onMap([1, 0])[0] - onMap([0, 0])[0]);
});

rare('a place on the map is picked by keyboard: Enter takes the middle, arrow keys bring it there', async () => {
  await page.locator('#modes button[value="8"]').click();
  await page.locator('#goal').waitFor();
  await page.locator('#language').focus();
  while (await page.evaluate(() => document.activeElement?.id) !== 'map') await page.keyboard.press('Tab');
  for (const key of ['+', 'ArrowRight', 'ArrowRight', 'ArrowUp', 'Enter']) await page.keyboard.press(key);
  await page.waitForFunction(() => {
    const { state, onMap } = /** @type {any} */ (window).rumbo;
    const { goal } = state().robot.task;
    const map = document.querySelector('#map');
    if (!goal || !map) return false;
    const [x, y] = onMap(goal);
    return Math.hypot(x - map.clientWidth / 2, y - map.clientHeight / 2) < 2;
  });
  await page.locator('#fit').click();
});

rare('fingers move and zoom: map and plots', async () => {
  const cdp = await page.context().newCDPSession(page);
  await cdp.send('Emulation.setTouchEmulationEnabled', { enabled: true, maxTouchPoints: 2 });
  /** @param {'touchStart' | 'touchMove' | 'touchEnd'} type @param {[number, number][]} points */
  const touch = (type, ...points) => cdp.send('Input.dispatchTouchEvent', { type, touchPoints: points.map(([x, y], id) => ({ x, y, id })) });
  const map = await page.locator('#map').boundingBox();
  const plot = await page.locator('.u-over').first().boundingBox();
  assert.ok(map && plot);
  const before_px = await metre_px();
  const [x, y] = [map.x + map.width / 2, map.y + map.height / 2];
  await touch('touchStart', [x - 30, y], [x + 30, y]);
  await touch('touchMove', [x - 60, y], [x + 60, y]);
  await touch('touchEnd');
  await page.waitForFunction((before) => {
    const { onMap } = /** @type {any} */ (window).rumbo;
    return Math.abs(onMap([1, 0])[0] - onMap([0, 0])[0]) > 1.7 * before;
  }, before_px);
  await page.locator('#fit').click();

  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state().t_s > 3);
  const seen = () => page.evaluate(() => /** @type {[number, number]} */ (/** @type {any} */ (window).rumbo.plots().range_s));
  await page.locator('#pause').click();
  const [before_s] = await seen();
  await touch('touchStart', [plot.x + 100, plot.y + 20]);
  for (const dx of [20, 60, 100]) await touch('touchMove', [plot.x + 100 + dx, plot.y + 20]);
  await touch('touchEnd');
  await page.waitForFunction((before) => /** @type {any} */ (window).rumbo.plots().range_s[0] < before - 0.3, before_s);
  const [from_s, to_s] = await seen();
  assert.ok(Math.abs(to_s - from_s - 20) < 0.1, `${from_s} to ${to_s}`);
  await page.locator('#live').click();
  await cdp.send('Emulation.setTouchEmulationEnabled', { enabled: false });
});

test('lists hold lines, panels of tabs are no lists, and heads of columns say something', async () => {
  const odd = await page.evaluate(() => [...document.querySelectorAll(':is(ol, ul)[role], th:empty')]
    .concat([...document.querySelectorAll('li')].filter((line) => !line.parentElement?.matches('ol, ul')))
    .map((each) => each.outerHTML.slice(0, 80)));
  assert.deepEqual(odd, []);
});

test('everything that can be used has a name', async () => {
  const nameless = await page.evaluate(() => [...document.querySelectorAll('button, input, select, [tabindex], [role="tab"]')].filter((each) => {
    const named = each.getAttribute('aria-label') || each.getAttribute('title') || each.textContent?.trim() || each.closest('label')?.textContent?.trim() || each.getAttribute('aria-labelledby');
    return !named && !(each instanceof HTMLInputElement && each.hidden);
  }).map((each) => each.outerHTML.slice(0, 80)));
  assert.deepEqual(nameless, []);
});

rare('Tab reaches every part of the page and shows where it is', async () => {
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

rare('the longest fault fits beside the controls of every mode', async () => {
  const longest = Object.keys((await import('../../src/spanish/robot.js')).ROBOT).filter((text) => /^(left encoder|blocked|link lost|sonar)/.test(text)).sort((a, b) => b.length - a.length)[0] ?? '';
  assert.ok(longest.length > 80, longest);
  await page.addInitScript((fault) => {
    const { parse } = JSON;
    JSON.parse = (text) => {
      const message = parse(text);
      if (message?.type === 'state') message.state.robot.fault = fault;
      return message;
    };
  }, longest);
  for (const language of ['es', 'en']) {
    await page.locator('#language').selectOption(language);
    await page.waitForFunction((language) => document.documentElement.lang === language, language);
    for (const mode of [0, 7, 8]) {
      await page.locator(`#modes button[value="${mode}"]`).click();
      await page.locator(`#modes button[value="${mode}"][aria-pressed="true"]`).waitFor();
      for (const [width, height] of /** @type {[number, number][]} */ ([[1280, 720], [1024, 768]])) {
        await page.setViewportSize({ width, height });
        await page.locator('#fault').waitFor();
        await fits(`${language}, mode ${mode}, ${width} x ${height}`);
        assert.deepEqual(await beyond(), [0, 0], `${language}, mode ${mode}, ${width} x ${height}`);
      }
    }
  }
});

rare('what a parameter is can be read with a finger and with the keyboard, on a tablet too', async () => {
  const tablet = await open(['lab', '--scenario', 'mode8-obstacles', '--out', folder()], { viewport: { width: 900, height: 1180 }, hasTouch: true });
  try {
    const { page } = tablet;
    await page.waitForSelector('#connection.good');
    const about = page.locator('#parameter-about');
    await page.locator('#goal').waitFor();
    await eventually(async () => assert.equal(await page.locator('#goal-x').inputValue(), '2.5', 'the form begins with the experiment\'s goal'));
    await about.getByText('Tap a line').waitFor();
    await page.locator('#parameters td', { hasText: /^link_timeout_s$/ }).tap();
    await about.getByText('link_timeout_s Time without a sign of life after which the wheels are released.').waitFor();
    const box = await about.boundingBox();
    assert.ok(box && box.x >= 0 && box.x + box.width <= 900, JSON.stringify(box));
    // From one value to the next by Tab; each has its description attached.
    const input = page.locator('#parameter-link_timeout_s');
    await input.focus();
    await page.keyboard.press('Tab');
    const next = await page.evaluate(() => {
      const input = document.activeElement;
      const [id = ''] = input?.getAttribute('aria-describedby')?.split(' ') ?? [];
      return { name: input?.id.replace('parameter-', ''), text: document.getElementById(id)?.textContent };
    });
    assert.ok(next.name && next.name !== 'link_timeout_s' && next.text, JSON.stringify(next));
    await about.getByText(`${next.name} ${next.text}`).waitFor();
    await page.locator('#language').selectOption('es');
    await page.waitForFunction(() => document.documentElement.lang === 'es' && /** @type {any} */ (window).rumbo?.state());
    await page.locator('#parameter-link_timeout_s').tap();
    await about.getByText('Tiempo sin señal de vida tras el que se sueltan las ruedas.').waitFor();
    assert.deepEqual(tablet.complaints, []);
  } finally {
    await tablet.close();
  }
});
