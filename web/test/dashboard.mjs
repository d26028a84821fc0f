// @ts-check
/** The dashboard of a `rumbo` in a real browser, for the tests: RUMBO_BIN is the program, CHROMIUM the browser (default /usr/bin/chromium). */
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { mkdtempSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { createInterface } from 'node:readline';
import { chromium } from 'playwright-core';

const BROWSER_ARGS = [
  '--headless', '--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking',
  '--disable-component-update', '--disable-sync',
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
 */
export async function open(options) {
  const server = spawn(program(), [...options, '--no-browser', '--port', '0'], { stdio: ['ignore', 'pipe', 'inherit'] });
  assert.ok(server.stdout);
  let url = '';
  for await (const line of createInterface({ input: server.stdout })) {
    url = line.match(/http:\/\/\S+/)?.[0] ?? '';
    if (url) break;
  }
  const browser = await chromium.launch({ executablePath: process.env['CHROMIUM'] ?? '/usr/bin/chromium', args: BROWSER_ARGS });
  const page = await browser.newPage({ viewport: { width: 1280, height: 720 }, colorScheme: 'dark' });
  page.setDefaultTimeout(PATIENCE_MS);
  /** @type {string[]} */
  const complaints = [];
  page.on('pageerror', (error) => complaints.push(String(error)));
  page.on('console', (message) => {
    if (message.type() === 'error') complaints.push(message.text());
  });
  await page.goto(url);
  const close = async () => {
    await browser.close();
    server.kill();
  };
  return { url, browser, page, complaints, close };
}
