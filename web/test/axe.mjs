// @ts-check
/** What axe finds on a page. */
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';

const AXE = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');

/** Serious violations, with the elements. @param {import('playwright-core').Page} page @param {string} [within] an element @returns {Promise<string[]>} */
export async function violations(page, within = 'html') {
  await page.evaluate(AXE);
  return page.evaluate(async (within) => {
    const { violations } = await /** @type {any} */ (window).axe.run(within);
    return violations.filter((/** @type {any} */ { impact }) => ['serious', 'critical'].includes(impact))
      .flatMap((/** @type {any} */ { id, nodes }) => nodes.map((/** @type {any} */ node) => `${id}: ${node.html.slice(0, 140)} ${node.any[0]?.message ?? node.failureSummary ?? ''}`));
  }, within);
}
