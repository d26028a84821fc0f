// @ts-check
/** The plots: signals, axes, zoom, mark, layouts and pictures. */
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, test } from 'node:test';
import { eventually, folder, open, rare } from '../dashboard.mjs';

/** @type {Awaited<ReturnType<typeof open>>} */
let dashboard;
/** @type {import('playwright-core').Page} */
let page;

before(async () => {
  dashboard = await open(['lab', '--speed', '4', '--out', folder()]);
  page = dashboard.page;
  await page.waitForSelector('#connection.good');
  await page.locator('#on').click();
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.series('left_pwm').t.length > 50);
});

after(() => dashboard?.close());

/** @returns {Promise<{layout: import('../../src/layout.js').Layout, range_s: [number, number], mark_s: number | null, following: boolean}>} */
const plots = () => page.evaluate(() => /** @type {any} */ (window).rumbo.plots());
/** The titles of the plots that are seen. */
const titles = () => page.locator('.plot-head b').allTextContents();

/** Opens the dialog of the plot with this title. @param {string} title */
const change = (title) => page.getByRole('button', { name: `Change the plot ${title}` }).click();

/** What is saved by a click. @param {string} button */
async function saved(button) {
  const [download] = await Promise.all([page.waitForEvent('download'), page.getByRole('button', { name: button, exact: true }).click()]);
  return { name: download.suggestedFilename(), path: await download.path() };
}

/** Loads a layout file. @param {string} name @param {string} text */
async function load(name, text) {
  await page.locator('#layout-dialog input[type=file]').setInputFiles({ name, mimeType: 'application/json', buffer: Buffer.from(text) });
}

test('a plot with chosen signals is added, and a reload keeps it', async () => {
  await page.locator('#add-plot').click();
  await page.locator('#plot-title').fill('errors');
  await page.getByLabel('error of the speed, left wheel').check();
  await page.getByLabel('error of the speed, right wheel').check();
  await page.locator('#plot-expression').fill('left_rpm - rigth_rpm');
  await page.locator('#plot-dialog button[type=submit]').click();
  await page.locator('#plot-dialog .complaint', { hasText: 'there is no signal rigth_rpm' }).waitFor();
  await page.locator('#plot-expression').fill('left_rpm - right_rpm');
  await page.locator('#plot-dialog button[type=submit]').click();
  assert.deepEqual(await titles(), ['distance', 'wheels', 'PWM', 'errors']);
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.series('left_error_rpm').y.some((/** @type {unknown} */ y) => typeof y === 'number'));
  await page.reload();
  await page.locator('.plot-head b', { hasText: 'errors' }).waitFor();
  await page.locator('.plot-head', { hasText: 'errors' }).locator('.curve', { hasText: /^left_rpm - right_rpm\s*[−\d]/ }).waitFor();
});

rare('a locked axis keeps its limits, also through a reload', async () => {
  await change('errors');
  await page.locator('#plot-min').fill('-50');
  await page.locator('#plot-max').fill('50');
  await page.locator('#plot-dialog button[type=submit]').click();
  await page.reload();
  await page.locator('.plot-head', { hasText: 'errors' }).locator('button', { hasText: 'lock' }).and(page.locator('[aria-pressed="true"]')).waitFor();
  const spec = (await plots()).layout.plots.at(-1);
  assert.deepEqual([spec?.min, spec?.max], [-50, 50]);
  await change('errors');
  await page.getByRole('button', { name: 'Remove plot' }).click();
  assert.deepEqual(await titles(), ['distance', 'wheels', 'PWM']);
});

rare('signals of a second unit have the axis on the right, those of a third cannot be taken, and a layout keeps it', async () => {
  await change('PWM');
  await page.getByLabel('speed, left wheel', { exact: true }).check();
  assert.equal(await page.getByLabel('true heading').isDisabled(), true, 'a third unit');
  await page.locator('#plot-right-min').fill('-200');
  await page.locator('#plot-right-max').fill('200');
  await page.locator('#plot-dialog button[type=submit]').click();
  const head = page.locator('.plot-head', { hasText: 'PWM' });
  await head.locator('i', { hasText: 'rpm ▸' }).waitFor();
  // Its number goes on, though its table has other lines than that of the PWM.
  await head.locator('.curve', { hasText: 'left' }).nth(1).locator('output', { hasText: /\d/ }).waitFor();
  const spec = (await plots()).layout.plots.find(({ title }) => title === 'PWM');
  assert.deepEqual([spec?.signals, spec?.min, spec?.right], [['left_pwm', 'right_pwm', 'left_rpm'], null, [-200, 200]]);
  const scale = await page.evaluate(() => /** @type {any} */ (window).rumbo.scales('PWM'));
  assert.deepEqual(scale.right, [-200, 200]);
  assert.ok(scale.y[1] < scale.right[1] + 120 && scale.y[0] > -200, `the left one goes by its values: ${scale.y}`);
  await change('PWM');
  const svg = await saved('SVG');
  assert.match(readFileSync(svg.path, 'utf8'), /left \[rpm\]/);
  await page.getByLabel('speed, left wheel', { exact: true }).uncheck();
  await page.locator('#plot-dialog button[type=submit]').click();
  assert.equal(await head.locator('i', { hasText: '▸' }).count(), 0);
});

test('a box zooms into time and value, the data goes on, and L follows it again', async () => {
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.series('left_pwm').t.at(-1) > 6);
  const box = await page.locator('.u-over').first().boundingBox();
  assert.ok(box);
  await page.mouse.move(box.x + 100, box.y + 10);
  await page.mouse.down();
  await page.mouse.move(box.x + 160, box.y + 60, { steps: 4 });
  // The plot takes what is dragged in the next frame.
  await page.waitForFunction(() => Math.min(...[...document.querySelectorAll('.u-select')].slice(0, 1).flatMap((of) => [of.clientWidth, of.clientHeight])) > 30);
  await page.mouse.up();
  const zoomed = await plots();
  assert.equal(zoomed.following, false);
  assert.ok(zoomed.range_s[1] - zoomed.range_s[0] < 4, String(zoomed.range_s));
  await page.waitForFunction((t) => /** @type {any} */ (window).rumbo.series('left_pwm').t.at(-1) > t, zoomed.range_s[1] + 1);
  assert.deepEqual((await plots()).range_s, zoomed.range_s, 'the view holds still');
  await page.keyboard.press('l');
  assert.equal((await plots()).following, true);
});

rare('a click sets a mark, from which the numbers in all plots are counted', async () => {
  const band = page.locator('.u-over').first();
  await band.click({ position: { x: 90, y: 30 } });
  await band.hover({ position: { x: 200, y: 30 } });
  await page.locator('#cursor-time', { hasText: /^[\d.]+ s {2}Δ [\d.]+ s( {2}1: \w+)?$/ }).waitFor();
  await page.locator('.plot-head', { hasText: 'PWM' }).locator('output', { hasText: /Δ/ }).first().waitFor();
  // The state at the pointer is shown too: the band has room for the names of long ones only.
  await band.hover({ position: { x: 100, y: 30 } });
  await page.locator('#cursor-time', { hasText: /1: (off|approach|settle|hold)$/ }).waitFor();
  await page.locator('#plots').focus();
  await page.keyboard.press('Escape');
  assert.equal((await plots()).mark_s, null);
});

rare('the view slides with the newest data, as wide as the chosen window', async () => {
  await page.locator('#window').selectOption('10');
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.series('left_pwm').t.at(-1) > 11);
  // It is drawn with the next frame.
  await page.waitForFunction(() => { const [from_s, to_s] = /** @type {any} */ (window).rumbo.plots().range_s; return to_s - from_s < 11; });
  const { range_s: [from_s, to_s] } = await plots();
  assert.ok(Math.abs(to_s - from_s - 10) < 1e-6 && from_s > 0, `${from_s} to ${to_s}`);
  await page.waitForFunction((before) => /** @type {any} */ (window).rumbo.plots().range_s[1] > before + 0.5, to_s);
  await page.locator('#window').selectOption('20');
});

rare('a click on lock keeps the axis as it is, another lets it go', async () => {
  const lock = page.locator('.plot-head', { hasText: 'wheels' }).getByRole('button', { name: 'lock' });
  const wheels = async () => (await plots()).layout.plots.find(({ title }) => title === 'wheels');
  await lock.click();
  const scale = await page.evaluate(() => /** @type {any} */ (window).rumbo.scales('wheels').y);
  const kept = await wheels();
  assert.deepEqual([kept?.min, kept?.max], scale);
  await lock.click();
  assert.equal((await wheels())?.min, null);
});

rare('the states of the run stand below the plots, each in its own colour', async () => {
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.series('range_front_cm').y.slice(-25).every((/** @type {number} */ cm) => Math.abs(cm - 30) < 3));
  // The beginning too, however slow the machine is.
  await page.locator('#window').selectOption('60');
  const colours = () => page.evaluate(() => {
    const canvas = /** @type {HTMLCanvasElement} */ ([...document.querySelectorAll('#plots canvas')].at(-1));
    const row = canvas.getContext('2d')?.getImageData(0, 10, canvas.width, 1).data ?? [];
    /** @type {Record<string, number>} */
    const count = {};
    for (let at = 0; at < row.length; at += 4) {
      const key = `${row[at]},${row[at + 1]},${row[at + 2]}`;
      if (row[at + 3]) count[key] = (count[key] ?? 0) + 1;
    }
    return Object.values(count).filter((each) => each > 3).length;
  });
  await eventually(async () => {
    const seen = await colours();
    assert.ok(seen >= 4, `off, approach, settle and hold: ${seen}`);
  });
  await page.locator('#window').selectOption('20');
});

rare('a plot is a figure of chosen time and size, as SVG, PNG and PDF, and its values a CSV', async () => {
  await change('distance');
  const svg = await saved('SVG');
  assert.equal(svg.name, 'distance.svg');
  const text = readFileSync(svg.path, 'utf8');
  assert.ok(text.startsWith('<svg ') && text.includes('distance [cm]') && /<path d="M-?[\d.]+ -?[\d.]+L/.test(text), 'a title and a curve');
  const png = await saved('PNG');
  assert.deepEqual([...readFileSync(png.path).subarray(1, 4)], [...Buffer.from('PNG')]);
  const csv = await saved('CSV');
  const [head = '', first = '', second = ''] = readFileSync(csv.path, 'utf8').split('\n');
  assert.match(head, /^t \[s\],true_range_front_cm \[cm\],range_front_cm \[cm\],reference_cm \[cm\]$/);
  assert.match(first, /^[\d.]+(,[\d.]*){3}$/);
  assert.ok(Math.abs(Number(second.split(',')[0]) - Number(first.split(',')[0]) - 0.04) < 0.002, 'a line for each frame');
  await page.locator('#figure-from').fill('1');
  await page.locator('#figure-to').fill('2');
  await page.locator('#figure-width').fill('100');
  await page.locator('#figure-height').fill('50');
  assert.match(readFileSync((await saved('SVG')).path, 'utf8'), /viewBox="0 0 378 189"/);
  const { path } = await saved('PNG');
  const [width, height] = [readFileSync(path).readUInt32BE(16), readFileSync(path).readUInt32BE(20)];
  assert.ok(Math.abs(width - 1181) < 3 && Math.abs(height - 590) < 3, `300 dots to an inch: ${width} x ${height}`);
  const times = readFileSync((await saved('CSV')).path, 'utf8').trim().split('\n').slice(1).map((line) => Number(line.split(',')[0]));
  assert.ok(times.length > 20 && times.every((t_s) => t_s >= 1 && t_s <= 2), `${times[0]} to ${times.at(-1)}`);
  await page.evaluate(() => { window.print = () => {}; });
  await page.getByRole('button', { name: 'PDF' }).click();
  await page.locator('#printed').waitFor({ state: 'attached' });
  const pdf = (await page.pdf({ preferCSSPageSize: true })).toString('latin1');
  const [, wide, high] = pdf.match(/\/MediaBox\s*\[0 0 ([\d.]+) ([\d.]+)\]/) ?? [];
  assert.ok(Math.abs(Number(wide) - 286) < 2 && Math.abs(Number(high) - 144.6) < 2, `points: ${wide} x ${high}`);
  assert.equal(pdf.match(/\/Type\s*\/Page\b/g)?.length, 1, 'one page');
  await page.evaluate(() => dispatchEvent(new Event('afterprint')));
  assert.equal(await page.locator('#printed').count(), 0);
  await page.locator('#figure-to').fill('1');
  await page.getByRole('button', { name: 'PNG' }).click();
  await page.locator('#plot-dialog .complaint', { hasText: 'from a time to a later one' }).waitFor();
  await page.keyboard.press('Escape');
});

rare('a layout is saved by name and as a file, and loaded again', async () => {
  await page.locator('#plot-choice button', { hasText: 'position' }).click();
  await page.locator('#window').selectOption('60');
  await page.locator('#layouts').click();
  await page.locator('#layout-name').fill('mine');
  await page.getByRole('button', { name: 'Save', exact: true }).click();
  const file = await saved('Save file');
  assert.equal(file.name, 'mine.layout.json');
  await page.locator('#layout-initial').click();
  assert.deepEqual(await titles(), ['distance', 'wheels', 'PWM']);
  await page.locator('#layouts').click();
  await page.getByRole('button', { name: 'mine', exact: true }).click();
  assert.deepEqual(await titles(), ['distance', 'wheels', 'PWM', 'position']);
  assert.equal((await plots()).layout.window_s, 60);
  await page.locator('#layouts').click();
  await page.locator('#layout-initial').click();
  await page.locator('#layouts').click();
  await load('mine.layout.json', readFileSync(file.path, 'utf8'));
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.plots().layout.window_s === 60);
});

rare('a file that is no layout is refused with the reason, and nothing changes', async () => {
  const before = (await plots()).layout;
  await page.locator('#layouts').click();
  const spec = { title: 'a', signals: ['no_such_signal'] };
  for (const [text, why] of /** @type {[string, RegExp][]} */ ([
    ['{', /x\.json is not taken: it is no JSON\. The plots are as they were\./],
    ['{"plots": []}', /it is no layout of Rumbo/],
    [JSON.stringify({ rumbo: 'layout', version: 7, window_s: 20, plots: [] }), /its version is 7, this page knows 1/],
    [JSON.stringify({ rumbo: 'layout', version: 1, window_s: 20, plots: [spec] }), /plot 1 has a signal that is none: no_such_signal/],
    [JSON.stringify({ rumbo: 'layout', version: 1, window_s: 20, plots: [{ title: 'a', signals: ['left_pwm', 'left_rpm', 'x_m'] }] }), /plot 1 have more than two units: of 255, rpm, m/],
  ])) {
    await load('x.json', text);
    await page.locator('#layout-dialog .complaint', { hasText: why }).waitFor();
  }
  assert.deepEqual((await plots()).layout, before);
  await page.keyboard.press('Escape');
});

test('the pointer on the map draws the map alone, and curves without new data are not drawn again', async () => {
  await page.locator('#speed').selectOption('0');
  await page.locator('#connection', { hasText: 'paused' }).waitFor();
  const drawn = await page.evaluate(async () => {
    const map = /** @type {HTMLCanvasElement} */ (document.querySelector('#map'));
    const { clearRect } = CanvasRenderingContext2D.prototype;
    let [maps, others] = [0, 0];
    CanvasRenderingContext2D.prototype.clearRect = /** @this {CanvasRenderingContext2D} @param {[number, number, number, number]} all */ function (...all) {
      if (this.canvas === map) maps += 1;
      else others += 1;
      clearRect.apply(this, all);
    };
    for (let x = 10; x < 130; x += 4) {
      map.dispatchEvent(new PointerEvent('pointermove', { clientX: map.getBoundingClientRect().left + x, clientY: map.getBoundingClientRect().top + 60, bubbles: true }));
      await new Promise(requestAnimationFrame);
    }
    await new Promise((drawn) => setTimeout(drawn, 300));
    for (let again = 0; again < 10; again += 1) /** @type {any} */ (window).rumbo.draw();
    CanvasRenderingContext2D.prototype.clearRect = clearRect;
    return { maps, others, pointer: document.querySelector('#pointer')?.textContent };
  });
  // What came before the pause may still be drawn once.
  assert.ok(drawn.maps > 20 && drawn.others < drawn.maps && /x .* m/.test(drawn.pointer ?? ''), JSON.stringify(drawn));
  await page.locator('#speed').selectOption('4');
});

rare('what is plotted is cleared while data arrives', async () => {
  const last = await page.evaluate(() => /** @type {any} */ (window).rumbo.series('left_pwm').t.at(-1));
  await page.locator('#clear').click();
  await page.waitForFunction((t) => /** @type {any} */ (window).rumbo.series('left_pwm').t[0] >= t, last);
  assert.deepEqual(dashboard.complaints, []);
});

rare('what the control loops add up is plotted and can be chosen, and adds up to the PWM', async () => {
  const speeds = await open(['lab', '--scenario', 'mode5', '--out', folder()]);
  try {
    const own = speeds.page;
    await own.waitForSelector('#connection.good');
    await own.locator('#plot-choice button[value="left loop"]').click();
    await own.locator('#on').click();
    const names = ['left_p_pwm', 'left_i_pwm', 'left_d_pwm', 'left_feedforward_pwm'];
    // At a steady speed telemetry and terms may be of different ticks.
    await own.waitForFunction((terms) => {
      const last = (/** @type {string} */ name) => /** @type {any} */ (window).rumbo.series(name).y.at(-1);
      const [sum, pwm] = [terms.reduce((total, name) => total + (last(name) ?? NaN), 0), last('left_pwm')];
      return last('left_feedforward_pwm') > 50 && Math.abs(sum - pwm) < 25;
    }, names);
    await own.locator('.plot-head', { hasText: 'left loop' }).locator('.curve', { hasText: 'feedforward l.' }).locator('output', { hasText: /\d/ }).waitFor();
    await own.locator('#off').click();
    // A loop that is not at work has no value.
    await own.waitForFunction(() => /** @type {any} */ (window).rumbo.series('left_p_pwm').y.at(-1) === null);
    await own.locator('#add-plot').click();
    assert.equal(await own.getByLabel('speed loop, ramp, left wheel').count(), 1);
    assert.deepEqual(speeds.complaints, []);
  } finally {
    await speeds.close();
  }
});
