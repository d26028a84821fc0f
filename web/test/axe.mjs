// @ts-check
/** What axe finds on a page. */
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';

const AXE = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');

/** Violations, with the elements. @param {import('playwright-core').Page} page @param {string} [within] an element @param {string[]} [impacts] @returns {Promise<string[]>} */
export async function violations(page, within = 'html', impacts = ['minor', 'moderate', 'serious', 'critical']) {
  await page.evaluate(AXE);
  return page.evaluate(async ({ within, impacts }) => {
    const { violations } = await /** @type {any} */ (window).axe.run(within);
    return violations.filter((/** @type {any} */ { impact }) => impacts.includes(impact))
      .flatMap((/** @type {any} */ { id, nodes }) => nodes.map((/** @type {any} */ node) => `${id}: ${node.html.slice(0, 140)} ${node.any[0]?.message ?? node.failureSummary ?? ''}`));
  }, { within, impacts });
}

/** Serious ones only. @param {import('playwright-core').Page} page @param {string} [within] */
export const serious = (page, within) => violations(page, within, ['serious', 'critical']);
