// @ts-check
/** How a browser gets to the robot: the address that opens once, the file that opens the browser, two stations side by side. */
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { chmodSync, existsSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { folder, open, program, rare, showPage, start } from '../dashboard.mjs';

/** @type {Awaited<ReturnType<typeof open>>} */
let dashboard;

before(async () => {
  dashboard = await open(['lab', '--out', folder()]);
  await dashboard.page.waitForSelector('#connection.good');
});

after(() => dashboard?.close());

/** What the bar says to a browser of its own at this address. @param {string} url @param {string} locale @param {string} text */
async function says(url, locale, text) {
  const context = await dashboard.browser.newContext({ locale });
  const page = await context.newPage();
  await page.goto(url);
  await page.locator('#notice', { hasText: text }).waitFor();
  assert.equal(new URL(page.url()).search, '', 'the token does not stay in the address');
  await context.close();
}

test('an address that was opened before is reported with the remedy', async () => {
  await says(dashboard.url, 'en-GB', 'This address opens once, and was opened before.');
  // In the browser that opened it, it opens again.
  await (await showPage(dashboard.page.context(), dashboard.url)).close();
});

test('without a token the page names the address to open', async () => {
  await says(new URL('/', dashboard.url).href, 'en-GB', 'open the address that rumbo printed');
});

rare('two stations on one computer work side by side in one browser', async () => {
  const { server, url } = await start(['lab', '--out', folder()]);
  try {
    const other = await showPage(dashboard.page.context(), url);
    for (const page of [dashboard.page, other]) {
      await page.reload();
      await page.waitForSelector('#connection.good');
    }
    assert.deepEqual(await dashboard.page.context().cookies(), [], 'a cookie would go to both');
    await other.close();
  } finally {
    server.kill();
  }
});

rare('the file that the program opens leads the browser to the page', async () => {
  const place = folder();
  const opener = join(place, 'xdg-open');
  writeFileSync(opener, '#!/bin/sh\ncp "$1" "$0.part"\nmv "$0.part" "$0.html"\n');
  chmodSync(opener, 0o700);
  const environment = { ...process.env, PATH: `${place}:${process.env['PATH']}`, XDG_RUNTIME_DIR: place, HOME: place };
  const server = spawn(program(), ['lab', '--port', '0', '--out', place], { stdio: 'ignore', env: environment });
  try {
    while (!existsSync(`${opener}.html`)) await new Promise((resolve) => setTimeout(resolve, 20));
    const page = await dashboard.page.context().newPage();
    await page.goto(pathToFileURL(`${opener}.html`).href);
    await page.waitForSelector('#connection.good');
    await page.close();
  } finally {
    server.kill();
  }
});

rare('a page that misses the answer for its token asks again and gets its key', async () => {
  const { server, url } = await start(['lab', '--out', folder()]);
  const context = await dashboard.browser.newContext();
  try {
    const page = await context.newPage();
    let missed = false;
    await page.route(({ pathname }) => pathname === '/key', async (route) => {
      if (missed) return route.continue();
      missed = true;
      await route.fetch();
      return route.abort();
    });
    await page.goto(url);
    await page.waitForSelector('#connection.good');
    assert.ok(missed);
  } finally {
    await context.close();
    server.kill();
  }
});
