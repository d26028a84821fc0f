// @ts-check
/** What the page says of an order that is not obeyed: beside its button, and over everything where it is STOP. */
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { createReadStream, openSync, write } from 'node:fs';
import { createServer } from 'node:net';
import { createInterface } from 'node:readline';
import { test } from 'node:test';
import { eventually, folder, open, program } from '../dashboard.mjs';

/** Pictures go there, if somebody wants some. */
const PICTURES = process.env['SCREENSHOTS'];

/** @param {import('playwright-core').Page} page @param {string} name */
async function picture(page, name) {
  if (!PICTURES) return;
  await page.screenshot({ path: `${PICTURES}/${name}.png` });
  const size = page.viewportSize();
  await page.setViewportSize({ width: 390, height: 844 });
  await page.locator('#on').scrollIntoViewIfNeeded();
  await page.screenshot({ path: `${PICTURES}/${name}-390.png` });
  if (size) await page.setViewportSize(size);
}

/** A simulated robot behind a TCP port, whose link can be cut. */
async function robot() {
  const server = spawn(program(), ['lab', '--pty', '--scenario', 'mode1'], { stdio: ['ignore', 'pipe', 'inherit'] });
  const { value: pty } = await createInterface({ input: server.stdout })[Symbol.asyncIterator]().next();
  const fd = openSync(pty, 'r+');
  const from = createReadStream('', { fd, autoClose: false });
  // The program has ended, and its terminal with it.
  from.on('error', () => {});
  const link = { cut: false };
  const tcp = createServer((socket) => {
    const pass = (/** @type {string | Buffer} */ bytes) => { if (!link.cut) socket.write(bytes); };
    from.on('data', pass);
    socket.on('data', (bytes) => { if (!link.cut) write(fd, bytes, () => {}); });
    socket.on('error', () => {});
    socket.on('close', () => from.off('data', pass));
  });
  await new Promise((listening) => tcp.listen(0, '127.0.0.1', () => listening(null)));
  const { port } = /** @type {import('node:net').AddressInfo} */ (tcp.address());
  const close = () => {
    tcp.close();
    server.kill();
  };
  return { address: `tcp:127.0.0.1:${port}`, link, close };
}

test('ON where no wall is near is refused beside the button, until the next order', async () => {
  const { page, close } = await open(['lab', '--scenario', 'mode1', '--world', 'open', '--out', folder()]);
  try {
    await page.waitForSelector('#connection.good');
    await page.locator('#aim', { hasText: /^ON starts it/ }).waitFor();
    await page.locator('#on').click();
    const refusal = page.locator('#refusal', { hasText: 'ON: refused, no wall within reach' });
    await refusal.waitFor();
    assert.doesNotMatch(await refusal.innerText(), /wiring/);
    await eventually(async () => assert.doesNotMatch(await page.locator('#aim').innerText(), /ON starts it/));
    const [on, why] = [await page.locator('#on').boundingBox(), await refusal.boundingBox()];
    assert.ok(on && why && Math.abs(why.y - on.y) < 30, `${JSON.stringify(on)} ${JSON.stringify(why)}`);
    await picture(page, 'refusal');
    await page.locator('#off').click();
    await page.locator('#refusal').waitFor({ state: 'hidden' });
  } finally {
    await close();
  }
});

test('STOP that nobody confirms is an alarm until somebody does, and an ON for a robot that is gone is refused', async () => {
  const { address, link, close: end } = await robot();
  const { page, close } = await open(['connect', address, '--out', folder()]);
  try {
    await page.waitForSelector('#connection.good');
    if (await page.locator('dialog[open]').count() > 0) await page.keyboard.press('Escape');
    link.cut = true;
    await page.waitForSelector('#connection.bad');
    await page.locator('#on').click();
    await page.locator('#refusal', { hasText: 'ON: refused, no robot answers' }).waitFor();
    await page.locator('#stop').click();
    await page.locator('#alarm', { hasText: 'ALARM: the robot does not confirm STOP; switch off its battery' }).waitFor();
    await picture(page, 'alarm');
    link.cut = false;
    await page.waitForSelector('#connection.good');
    await page.locator('#alarm').waitFor({ state: 'hidden' });
    assert.equal(await page.evaluate(() => /** @type {any} */ (window).rumbo.state().robot.armed), false);
  } finally {
    await close();
    end();
  }
});
