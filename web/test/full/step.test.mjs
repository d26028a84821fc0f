// @ts-check
/** The figures of a step on the page are those of the metrics, which the program computes from ground truth. */
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { join } from 'node:path';
import { test } from 'node:test';
import { folder, open, program } from '../dashboard.mjs';

for (const { scenario, kind, tolerance } of [{ scenario: 'mode1', kind: 'm', tolerance: 1 }, { scenario: 'mode5', kind: 'rad_s', tolerance: 2 }]) {
  test(`${scenario}: the page's figures are those of the run's metrics`, async () => {
    const out = folder();
    const factor = kind === 'm' ? 100 : 30 / Math.PI;
    const { metrics } = JSON.parse(execFileSync(program(), ['run', scenario, '--seed', '1', '--json', '--out', out], { encoding: 'utf8' }));
    const dashboard = await open(['replay', join(out, `${scenario}-1.mcap`), '--speed', '16']);
    try {
      const { page } = dashboard;
      await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state()?.speed === 0);
      const numbers = Object.keys(metrics).flatMap((name) => name.match(/^step(\d+)\.rms/)?.[1] ?? []);
      await page.waitForFunction((count) => /** @type {any} */ (window).rumbo.figures().length === count, numbers.length);
      /** @type {({[key: string]: number} & {unit: string})[]} */
      const steps = await page.evaluate(() => /** @type {any} */ (window).rumbo.figures());
      for (const [index, step] of steps.entries()) {
        const expected = (/** @type {string} */ name) => metrics[`step${index + 1}.${name}`];
        for (const name of ['settling_s', 'rise_s']) {
          const [page, run] = [step[name], expected(name)];
          // The wheels' ramps and the telemetry of 25 Hz leave this much.
          if (typeof run === 'number' && typeof page === 'number') assert.ok(Math.abs(page - run) < 0.15, `step ${index + 1}: ${name} ${page}, ${run}`);
          else assert.equal(page ?? null, run ?? null, `step ${index + 1}: ${name}`);
        }
        for (const name of ['overshoot', 'steady_error']) {
          const [page, run] = [step[name] ?? NaN, factor * expected(`${name}_${kind}`)];
          assert.ok(Math.abs(page - run) < tolerance, `step ${index + 1}: ${name} ${page}, ${run}`);
        }
      }
      await page.locator('#step-figures dd').nth(2).filter({ hasText: /\d s/ }).waitFor();
    } finally {
      await dashboard.close();
    }
  });
}
