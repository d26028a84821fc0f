// @ts-check
/** *Run the experiment*: the scenario's commands at their times, and the verdict of the command line. */
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readdirSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { violations } from '../axe.mjs';
import { parse, work } from '../../src/law.js';
import { eventually, folder, open, program, rare } from '../dashboard.mjs';

test('the experiment is run, and its verdict has the numbers of rumbo run; the session runs again byte for byte', async () => {
  const out = folder();
  const dashboard = await open(['lab', '--scenario', 'mode1', '--out', out], { viewport: { width: 1280, height: 800 } });
  const { page } = dashboard;
  const verdict = page.locator('#experiment-words');
  try {
    await page.waitForSelector('#connection.good');
    await page.locator('#play').click();
    await verdict.filter({ hasText: / of 9 s/ }).waitFor();
    assert.equal(await page.locator('#play').isDisabled(), true);
    await page.locator('#reference button').click();
    await page.locator('#events li', { hasText: 'refused, the experiment runs; STOP ends it' }).waitFor();
    await page.locator('#speed').selectOption('8');
    await verdict.filter({ hasText: 'passed: 7 of 7 limits kept' }).waitFor();
    assert.equal(await page.locator('#play').isDisabled(), false);
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

rare('the law of mode 9 has what its network says', async () => {
  const dashboard = await open(['lab', '--scenario', 'mode9-random', '--out', folder()]);
  const { page } = dashboard;
  try {
    await page.getByRole('tab', { name: 'Law' }).click();
    await page.locator('#play').click();
    for (const wheel of ['left', 'right']) await page.locator('#law .law', { hasText: new RegExp(`^${wheel}_ref_rad_s −?[\\d.]+ = network_${wheel} −?[\\d.]+ · slower 1 · 12 $`) }).waitFor();
  } finally {
    await dashboard.close();
  }
});

/** The equations that the control core has for people give what the robot computed: of the wheels' PWM and mode 1's speed. @param {import('playwright-core').Page} page */
async function lawsHold(page) {
  const { laws, parameters, series } = await page.evaluate(() => {
    const rumbo = /** @type {any} */ (window).rumbo;
    const rows = [...document.querySelectorAll('#parameters tr')].flatMap((row) => {
      const [name, value] = [row.querySelector('td')?.textContent, row.querySelector('input')?.value];
      return name && value ? [[name.trim(), Number(value)]] : [];
    });
    const names = ['left_pwm', 'left_p_pwm', 'left_i_pwm', 'left_d_pwm', 'left_feedforward_pwm', 'forward_ref_m_s', 'range_front_cm', 'reference_cm'];
    return { laws: rumbo.modes().find((/** @type {any} */ { id }) => id === 1).laws, parameters: Object.fromEntries(rows), series: Object.fromEntries(names.map((name) => [name, rumbo.series(name)])) };
  });
  /** @param {string} name @param {number} t_s */
  const at = (name, t_s) => {
    const own = { range_front_m: 'range_front_cm', reference_m: 'reference_cm' }[name] ?? name;
    const { t, y } = series[own];
    return y[t.findLastIndex((/** @type {number} */ each) => each <= t_s)] / (own === name ? 1 : 100);
  };
  const lawOf = (/** @type {string} */ gives) => parse(laws.find((/** @type {any} */ [name]) => name === gives)[1]);
  for (const [gives, near] of /** @type {[string, number][]} */ ([['forward_ref_m_s', 0.01], ['left_pwm', 10]])) {
    const { t, y } = series[gives];
    const off = t.flatMap((/** @type {number} */ t_s, /** @type {number} */ index) => {
      const given = y[index];
      const value = (/** @type {string} */ name) => (name === 'error_m' ? work(lawOf('error_m'), value) : parameters[name] ?? at(name, t_s));
      const own = work(lawOf(gives), value);
      return typeof given === 'number' && given !== 0 && Number.isFinite(own) ? [Math.abs(own - given)] : [];
    });
    // Telemetry and loops are of instants up to 40 ms apart: where the PWM jumps they differ.
    const middle = off.sort((/** @type {number} */ one, /** @type {number} */ other) => one - other)[off.length >> 1];
    assert.ok(off.length > 50 && middle < near, `${gives}: ${middle}, of ${off.length}`);
  }
}

test('a kept run stays behind the curves and is compared with the next, which is explained; twenty seeds are driven beside it, and one becomes it', async () => {
  const dashboard = await open(['lab', '--scenario', 'mode1', '--speed', '8', '--out', folder()]);
  const { page } = dashboard;
  const passed = () => page.locator('#experiment-words', { hasText: /passed|failed/ }).waitFor();
  const shot = (/** @type {string} */ name) => process.env['SCREENSHOTS'] && page.screenshot({ path: `${process.env['SCREENSHOTS']}/${name}.png` });
  try {
    await page.waitForSelector('#connection.good');
    await page.locator('#play').click();
    await passed();
    await lawsHold(page);
    await page.locator('#keep-run').click();
    await page.locator('#runs', { hasText: 'Runs: 1' }).waitFor();
    await page.reload();
    await page.waitForSelector('#connection.good');
    await page.locator('#runs', { hasText: 'Runs: 1' }).waitFor();
    // Later and harder than friction can brake.
    for (const [name, value] of [['front_kp', '15'], ['front_brake_m_s2', '2']]) {
      const gain = page.locator('#parameters tr', { hasText: name }).locator('input').first();
      await gain.fill(value ?? '');
      await gain.press('Enter');
    }
    await page.waitForFunction(() => ![...document.querySelectorAll('#parameters tr.pending')].length);
    await page.getByRole('tab', { name: 'Law' }).click();
    await page.locator('#play').click();
    await page.locator('#law .law', { hasText: 'forward_ref_m_s' }).locator('.lit', { hasText: 'front_cruise_m_s' }).waitFor();
    await passed();
    await page.locator('#law button', { hasText: 'front_kp' }).first().click();
    const slider = page.getByRole('slider', { name: 'front_kp' });
    assert.deepEqual([await slider.getAttribute('min'), await slider.getAttribute('max')], ['3.75', '20']);
    await shot('overlay');
    await page.locator('#explain').click();
    await page.locator('#why', { hasText: /friction slowed the robot by [\d.]+ m\/s²; front_brake_m_s2 counts on 2/ }).waitFor();
    assert.deepEqual(await violations(page, '#event-section'), []);
    await shot('explain');
    await page.locator('#runs').click();
    const cells = (/** @type {string} */ row) => page.locator('#comparison tr', { hasText: row }).first().locator('td').allInnerTexts();
    await eventually(async () => assert.deepEqual((await cells('front_kp')).slice(1, 3), ['5', '15']));
    const [, one, other] = (await cells('step 1: overshoot')).map(Number);
    assert.ok(Number(other) > Number(one) + 1, 'it goes beyond the setpoint');
    assert.deepEqual(await violations(page, '#runs-dialog'), []);
    await shot('runs');
    await page.locator('#seeds-start').click();
    await page.locator('#seeds button', { hasText: /^7$/ }).waitFor();
    assert.equal(await page.locator('#seeds button').count(), 21);
    // Their time counts from ON: the plots go there, and follow the next run, which nothing has explained.
    assert.equal(await page.evaluate(() => /** @type {any} */ (window).rumbo.plots().following), false);
    await page.locator('#play').click();
    await page.waitForFunction(() => /** @type {any} */ (window).rumbo.shown()?.t_s > 2 && /** @type {any} */ (window).rumbo.plots().following);
    assert.equal(await page.locator('#why .causes li').count(), 0);
    await shot('seeds');
    await page.locator('#seeds button', { hasText: /^7$/ }).click();
    await page.waitForFunction(() => /** @type {HTMLInputElement} */ (document.getElementById('seed')).value === '7');
    await passed();
    assert.deepEqual(dashboard.complaints, []);
  } finally {
    await dashboard.close();
  }
});
