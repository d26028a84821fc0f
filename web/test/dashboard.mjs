// @ts-check
/**
 * The dashboard of a `rumbo` in a real browser, for the tests: RUMBO_BIN is the program, CHROMIUM the browser (default /usr/bin/chromium).
 * With WEB=1 the page's files are those of this folder, not those built into the program.
 */
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { extname, join } from 'node:path';
import { createInterface } from 'node:readline';
import { chromium } from 'playwright-core';

export const BROWSER_ARGS = [
  '--headless', '--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking',
  '--disable-component-update', '--disable-sync',
  // A page whose files come from the folder has no address that the browser knows for local.
  ...(process.env['WEB'] ? ['--disable-features=LocalNetworkAccessChecks'] : []),
];
/** Long enough for any machine; nothing is judged by it [ms]. */
const PATIENCE_MS = 30_000;

/** The program to test. */
export function program() {
  const path = process.env['RUMBO_BIN'];
  assert.ok(path, 'RUMBO_BIN names the program to test');
  return path;
}

/** A folder of its own for what a test records. */
export const folder = () => mkdtempSync(join(tmpdir(), 'rumbo-'));

/**
 * Starts `rumbo` with these arguments and opens its page. What a script of the page complains of is collected in `complaints`.
 * @param {string[]} options
 * @param {import('playwright-core').BrowserContextOptions} [browserOptions]
 */
export async function open(options, browserOptions = {}) {
  const server = spawn(program(), [...options, '--no-browser', '--port', '0'], { stdio: ['ignore', 'pipe', 'inherit'] });
  assert.ok(server.stdout);
  let url = '';
  for await (const line of createInterface({ input: server.stdout })) {
    url = line.match(/http:\/\/\S+/)?.[0] ?? '';
    if (url) break;
  }
  const browser = await chromium.launch({ executablePath: process.env['CHROMIUM'] ?? '/usr/bin/chromium', args: BROWSER_ARGS });
  const page = await browser.newPage({ viewport: { width: 1280, height: 720 }, colorScheme: 'dark', locale: 'en-GB', ...browserOptions });
  page.setDefaultTimeout(PATIENCE_MS);
  /** @type {string[]} */
  const complaints = [];
  page.on('pageerror', (error) => complaints.push(String(error)));
  page.on('console', (message) => {
    if (message.type() === 'error') complaints.push(message.text());
  });
  if (process.env['WEB']) {
    await page.request.get(url);
    await serveFolder(page);
    await page.goto(new URL('/', url).href);
  } else {
    await page.goto(url);
  }
  const close = async () => {
    await browser.close();
    server.kill();
  };
  return { url, browser, page, complaints, close };
}

/** @type {Record<string, string>} */
const TYPES = { '.html': 'text/html; charset=utf-8', '.js': 'text/javascript; charset=utf-8', '.css': 'text/css; charset=utf-8', '.svg': 'image/svg+xml' };

/** The page gets its files from this folder. @param {import('playwright-core').Page} page */
async function serveFolder(page) {
  await page.route('**/*', (route) => {
    const { pathname, search } = new URL(route.request().url());
    const path = new URL(`..${pathname === '/' ? '/index.html' : pathname}`, import.meta.url);
    if (search !== '' || !existsSync(path)) return route.continue();
    return route.fulfill({ body: readFileSync(path), contentType: TYPES[extname(pathname)] ?? 'text/html; charset=utf-8' });
  });
}
