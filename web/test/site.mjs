// @ts-check
/** The site from a plain static server, for the tests: SITE is its folder, as `cargo xtask site` builds it. */
import { createReadStream, existsSync, readFileSync, statSync } from 'node:fs';
import { createServer } from 'node:http';
import { extname, join, normalize } from 'node:path';
import { PATIENCE_MS, launch, left } from './dashboard.mjs';

export const FOLDER = process.env['SITE'] ?? '';
/** Why there is nothing to test, or false. */
export const skip = existsSync(join(FOLDER, 'lab/rumbo_bg.wasm')) ? false : 'SITE is no site: run `cargo xtask site`, and name its folder';
if (skip && process.env['CI']) throw new Error(skip);

/** Below a folder, as the pages of a project are. */
const BELOW = '/rumbo/';
/** The script of the worker, and what the tests with a robot put before it. */
const WORKER = 'lab/worker.js';
const STAND_IN = 'stand_in.js';
/** @type {Record<string, string>} */
const TYPES = { '.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.svg': 'image/svg+xml', '.wasm': 'application/wasm', '.webmanifest': 'application/manifest+json' };

/**
 * Serves the site's files and nothing else, but for the port of a robot.
 * @param {import('./serial_robot.mjs').SerialRobot} [robot]
 * @returns {Promise<{url: string, close: () => void}>}
 */
function serve(robot) {
  const server = createServer((request, response) => {
    const { pathname } = new URL(request.url ?? '/', 'http://localhost');
    if (robot?.answer(pathname.slice(BELOW.length), request, response)) return undefined;
    if (robot && pathname.endsWith(STAND_IN)) return response.writeHead(200, { 'Content-Type': 'text/javascript' }).end(robot.script(`http://${request.headers.host}${BELOW}`));
    const path = join(FOLDER, normalize(pathname.slice(BELOW.length - 1)), pathname.endsWith('/') ? 'index.html' : '');
    if (!pathname.startsWith(BELOW) || !existsSync(path) || !statSync(path).isFile()) return response.writeHead(404).end();
    response.writeHead(200, { 'Content-Type': TYPES[extname(path)] ?? 'text/plain' });
    // The worker has its own `navigator`; imports come first, so the stand-in is one.
    if (robot && pathname.endsWith(WORKER)) return response.end(`import './${STAND_IN}';\n${readFileSync(path, 'utf8')}`);
    return createReadStream(path).pipe(response);
  });
  return new Promise((done) => {
    server.listen(0, '127.0.0.1', () => {
      const address = server.address();
      const port = address !== null && typeof address === 'object' ? address.port : 0;
      const close = () => {
        server.close();
        server.closeAllConnections();
      };
      done({ url: `http://127.0.0.1:${port}${BELOW}`, close });
    });
  });
}

/**
 * Opens the site. What its scripts complain of is in `complaints`, and requests that leave it are in `abroad`.
 * @param {import('playwright-core').BrowserContextOptions} [options]
 * @param {string} [link] what follows the `#` of its address
 * @param {string} [path] of a page other than the lab
 * @param {import('./serial_robot.mjs').SerialRobot} [robot] at a serial port of the browser
 */
export async function open(options = {}, link = '', path = '', robot = undefined) {
  const server = await serve(robot);
  const browser = await launch();
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, colorScheme: 'dark', locale: 'en-GB', ...options });
  const page = await context.newPage();
  page.setDefaultTimeout(PATIENCE_MS);
  await page.addInitScript(() => localStorage.setItem('rumbo.tour', 'seen'));
  if (robot) await page.addInitScript(robot.script(server.url));
  /** @type {string[]} */
  const complaints = [];
  /** @type {string[]} */
  const abroad = [];
  page.on('pageerror', (error) => complaints.push(String(error)));
  page.on('console', (message) => {
    if (message.type() === 'error') complaints.push(message.text());
  });
  context.on('request', (request) => {
    if (!request.url().startsWith(server.url) && !/^(blob|data):/.test(request.url())) abroad.push(request.url());
  });
  const close = async () => {
    left.delete(close);
    await context.close();
    server.close();
  };
  left.add(close);
  await page.goto(server.url + path + (link && `#${link}`));
  return { page, context, complaints, abroad, url: server.url, unplug: server.close, close };
}

/** The link of the run, from the dialog *Share*: it opens once the worker has given the run. @param {import('playwright-core').Page} page */
export async function share(page) {
  await page.locator('#share').click();
  await page.locator('#share-dialog').waitFor();
  return new URL(await page.locator('#share-link').inputValue());
}

/** Drops files on the page, together. @param {import('playwright-core').Page} page @param {{name: string, content: Buffer | string}[]} files */
export function dropOn(page, files) {
  const coded = files.map(({ name, content }) => ({ name, data: Buffer.from(content).toString('base64') }));
  return page.evaluate((coded) => {
    const transfer = new DataTransfer();
    for (const { name, data } of coded) transfer.items.add(new File([Uint8Array.from(atob(data), (each) => each.charCodeAt(0))], name));
    document.body.dispatchEvent(new DragEvent('drop', { dataTransfer: transfer, bubbles: true, cancelable: true }));
  }, coded);
}
