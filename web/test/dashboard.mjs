// @ts-check
/**
 * The dashboard of a `rumbo` in a real browser, for the tests: RUMBO_BIN is the program, CHROMIUM the browser (default /usr/bin/chromium).
 * With WEB=1 the page's files are those of this folder, not those built into the program. All tests of a process share one browser, with
 * a context for each page that they open.
 */
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { extname, join } from 'node:path';
import { after, test } from 'node:test';
import { createInterface } from 'node:readline';
import { chromium } from 'playwright-core';

const BROWSER_ARGS = [
  '--headless', '--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking',
  '--disable-component-update', '--disable-sync',
  // A page whose files come from the folder has no address that the browser knows for local.
  ...(process.env['WEB'] ? ['--disable-features=LocalNetworkAccessChecks'] : []),
];
/** The pages have a slow display: drawing sixty frames in a second would be most of the work of a test [ms]. */
const FRAME_MS = 100;
/** Long enough for any machine; nothing is judged by it [ms]. */
export const PATIENCE_MS = 120_000;

/**
 * Repeats a check of what the page shows until it holds: the page draws when the robot's next message comes, not when a click returns.
 * @template T
 * @param {() => Promise<T>} check throws while it does not hold
 * @returns {Promise<T>} what it gives
 */
export async function eventually(check) {
  for (const end = Date.now() + PATIENCE_MS; ;) {
    try {
      return await check();
    } catch (error) {
      if (Date.now() > end) throw error;
      await new Promise((again) => setTimeout(again, 50));
    }
  }
}

/** A path that is rare, and whose kind another test finds too: driven by the full check only. @type {(...all: any[]) => unknown} */
export const rare = process.env['FULL'] ? test : () => {};

/** @type {Promise<import('playwright-core').Browser> | null} */
let browser = null;

/** The browser of all tests of this process. */
export function launch() {
  browser ??= chromium.launch({ executablePath: process.env['CHROMIUM'] ?? '/usr/bin/chromium', args: BROWSER_ARGS, timeout: PATIENCE_MS });
  return browser;
}

/** What a test that has failed leaves open, which would keep its file from ending. @type {Set<() => unknown>} */
export const left = new Set();
after(async () => {
  for (const close of left) await close();
  await (await browser)?.close();
});

/** The program to test. */
export function program() {
  const path = process.env['RUMBO_BIN'];
  assert.ok(path, 'RUMBO_BIN names the program to test');
  return path;
}

/** A folder of its own for what a test records. */
export const folder = () => mkdtempSync(join(tmpdir(), 'rumbo-'));

/**
 * Starts `rumbo` with these arguments; gives its process, the address of its page, and what waits for the next address.
 * @param {string[]} options
 * @param {number} [port]
 */
export async function start(options, port = 0) {
  const server = spawn(program(), [...options, '--no-browser', '--port', String(port)], { stdio: ['ignore', 'pipe', 'inherit'] });
  const end = () => server.kill();
  left.add(end);
  server.on('exit', () => left.delete(end));
  assert.ok(server.stdout);
  const addresses = createInterface({ input: server.stdout })[Symbol.asyncIterator]();
  /** The next address that the program prints. */
  const address = async () => {
    for (;;) {
      const { value, done } = await addresses.next();
      const found = value?.match(/http:\/\/\S+/)?.[0];
      if (found || done) return found ?? '';
    }
  };
  const url = await address();
  assert.ok(url, `rumbo ${options.join(' ')}: no page`);
  return { server, url, address };
}

/**
 * Starts `rumbo` with these arguments and opens its page. What a script of the page complains of is collected in `complaints`.
 * @param {string[]} options
 * @param {import('playwright-core').BrowserContextOptions} [browserOptions]
 * @param {boolean} [firstTime] nobody has seen the first steps in this browser
 */
export async function open(options, browserOptions = {}, firstTime = false) {
  const { server, url, address } = await start(options);
  const browser = await launch();
  const context = await browser.newContext({ viewport: { width: 1280, height: 720 }, colorScheme: 'dark', locale: 'en-GB', ...browserOptions });
  const page = await context.newPage();
  /** @type {string[]} */
  const complaints = [];
  await prepare(page, firstTime);
  page.on('pageerror', (error) => complaints.push(String(error)));
  page.on('console', (message) => {
    if (message.type() === 'error') complaints.push(message.text());
  });
  await page.goto(url);
  const close = async () => {
    await context.close();
    server.kill();
  };
  /** The address for viewers, which `--listen` prints after the other. */
  return { server, url, viewersUrl: address, browser, page, complaints, close };
}

/** A page of this context at an address of the program. @param {import('playwright-core').BrowserContext} context @param {string} url */
export async function showPage(context, url) {
  const page = await context.newPage();
  await prepare(page);
  await page.goto(url);
  await page.waitForSelector('#connection.good');
  return page;
}

/** @param {import('playwright-core').Page} page @param {boolean} [firstTime] nobody has seen the first steps in this browser */
async function prepare(page, firstTime = false) {
  page.setDefaultTimeout(PATIENCE_MS);
  if (!firstTime) await page.addInitScript(() => localStorage.setItem('rumbo.tour', 'seen'));
  await page.addInitScript((frame_ms) => {
    window.requestAnimationFrame = (draw) => window.setTimeout(() => draw(performance.now()), frame_ms);
    window.cancelAnimationFrame = (id) => clearTimeout(id);
  }, FRAME_MS);
  if (process.env['WEB']) await serveFolder(page);
}

/** @type {Record<string, string>} */
const TYPES = { '.html': 'text/html; charset=utf-8', '.js': 'text/javascript; charset=utf-8', '.css': 'text/css; charset=utf-8', '.svg': 'image/svg+xml' };

/** The page gets its files from this folder. @param {import('playwright-core').Page} page */
async function serveFolder(page) {
  await page.route('**/*', (route) => {
    const { pathname } = new URL(route.request().url());
    const path = new URL(`..${pathname === '/' ? '/index.html' : pathname}`, import.meta.url);
    if (!existsSync(path)) return route.continue();
    return route.fulfill({ body: readFileSync(path), contentType: TYPES[extname(pathname)] ?? 'text/html; charset=utf-8' });
  });
}
