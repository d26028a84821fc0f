// @ts-check
/**
 * A real robot driven from the site, by a serial port of the browser: the port is a stand-in, the robot that of
 * `rumbo lab --pty`. SCREENSHOT_PORT is a file for a picture, with SCREENSHOT_PORT_PHONE for a phone's.
 */
import assert from 'node:assert/strict';
import { existsSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { serious as violations } from '../axe.mjs';
import { PATIENCE_MS, folder } from '../dashboard.mjs';
import { BootLoader, SerialRobot, startRobot } from '../serial_robot.mjs';
import { open, skip as noSite } from '../site.mjs';

const skip = noSite || (process.env['RUMBO_BIN'] ? false : 'RUMBO_BIN names no program');
/** A link whose run arms the robot of the lab. */
const ARMING = 'scenario=mode5&seed=1&drive=0.5+arm';

/** @type {import('../serial_robot.mjs').SerialRobot} */
let robot;
/** @type {Awaited<ReturnType<typeof open>>} */
let site;
/** @type {import('playwright-core').Page} */
let page;

before(async () => {
  if (skip) return;
  robot = await startRobot();
  site = await open({}, ARMING, '', robot);
  page = site.page;
});

after(async () => {
  await site?.close();
  robot?.close();
});

/** A program of eleven pages. */
const wanted = Array.from({ length: 2_600 }, (_, at) => (at * 7 + (at >> 8)) & 255);

/** A program as Intel HEX. @param {number[]} bytes */
function hex(bytes) {
  const lines = [];
  for (let at = 0; at < bytes.length; at += 16) {
    const data = bytes.slice(at, at + 16);
    const record = [data.length, at >> 8, at & 255, 0, ...data];
    record.push(-record.reduce((sum, byte) => sum + byte, 0) & 255);
    lines.push(`:${record.map((byte) => byte.toString(16).padStart(2, '0')).join('').toUpperCase()}\n`);
  }
  return `${lines.join('')}:00000001FF\n`;
}

/** The bytes of a whole program in Intel HEX, from address 0. @param {string} text */
function bytesOf(text) {
  const flash = Buffer.alloc(0x3_E000, 0xFF);
  let [base, end] = [0, 0];
  for (const line of text.split('\n').filter((each) => each.startsWith(':'))) {
    const record = Buffer.from(line.slice(1).trim(), 'hex');
    const [type, data] = [record[3], record.subarray(4, -1)];
    if (type === 2) base = 16 * data.readUInt16BE(0);
    if (type === 4) base = 0x1_0000 * data.readUInt16BE(0);
    if (type !== 0) continue;
    const at = base + record.readUInt16BE(1);
    data.copy(flash, at);
    end = Math.max(end, at + data.length);
  }
  return flash.subarray(0, end);
}

const state = () => page.evaluate(() => /** @type {any} */ (window).rumbo.state());
/** @param {boolean} armed */
const isArmed = (armed) => page.waitForFunction((armed) => /** @type {any} */ (window).rumbo.state()?.robot.armed === armed, armed);
/** @param {string | RegExp} text */
const says = (text) => page.locator('#events li', { hasText: text }).first().waitFor();
const connected = () => page.waitForFunction(() => /** @type {any} */ (window).rumbo.state()?.link.connected);
const turns = () => page.waitForFunction(() => Math.abs(/** @type {any} */ (window).rumbo.series('left_rpm').y.at(-1)) > 20);

test('somebody who chooses no port stays in the lab', { skip }, async () => {
  await isArmed(true);
  robot.chooses = false;
  await page.locator('#real-robot').click();
  await page.locator('#port-connect').click();
  await page.locator('#robot-dialog .complaint', { hasText: 'no port was chosen' }).waitFor();
  assert.equal((await state()).simulated, true);
  robot.chooses = true;
});

test('a real robot connects, and neither that nor the link of the page arms it', { skip }, async () => {
  await page.locator('#port-connect').click();
  await page.locator('#port-name', { hasText: 'port USB 2341:0042' }).waitFor();
  await connected();
  const { simulated, robot: { armed } } = await state();
  assert.deepEqual([simulated, armed], [false, false]);
  assert.equal(await page.locator('#simulation').isVisible(), false);
  await page.locator('#checkup-dialog button', { hasText: 'Close' }).click();
});

test('it drives, and Space stops it', { skip }, async () => {
  await page.locator('#modes button', { hasText: '5' }).first().click();
  await says('mode 5 wheel speed: acknowledged');
  await page.locator('#on').click();
  await isArmed(true);
  await page.locator('#reference input').first().fill('70');
  await page.locator('#reference button').first().click();
  await turns();
  if (process.env['SCREENSHOT_PORT']) await page.screenshot({ path: process.env['SCREENSHOT_PORT'] });
  if (process.env['SCREENSHOT_PORT_PHONE']) {
    await page.setViewportSize({ width: 390, height: 844 });
    await page.screenshot({ path: process.env['SCREENSHOT_PORT_PHONE'] });
    await page.setViewportSize({ width: 1280, height: 800 });
  }
  await page.locator('#map').focus();
  await page.keyboard.press('Space');
  await isArmed(false);
  await says('STOP: acknowledged');
});

test('a page that does nothing for seconds does not hold up the heartbeat, which is the worker\'s', { skip }, async () => {
  const before = robot.sent;
  await page.evaluate(() => {
    for (const end = performance.now() + 3_000; performance.now() < end;);
  });
  // Of 20 heartbeats of 5 bytes as many as a busy machine lets through; from the page itself there would be one.
  assert.ok(robot.sent >= before + 5 * 5, String(robot.sent - before));
});

test('one page of a browser drives a robot', { skip }, async () => {
  const other = await site.context.newPage();
  await other.addInitScript(robot.script(site.url));
  await other.goto(site.url);
  await other.waitForSelector('#connection.good');
  await other.locator('#real-robot').click();
  await other.locator('#port-connect').click();
  await other.locator('#robot-dialog .complaint', { hasText: 'another page of this browser drives a robot' }).waitFor();
  await other.close();
  assert.equal(await page.locator('#port-name').isVisible(), true);
});

test('a port that is gone is waited for, and nothing is sent late', { skip }, async () => {
  await page.locator('#on').click();
  await isArmed(true);
  robot.unplug();
  await says(/port USB 2341:0042 is gone \(.+\); waiting for it/);
  await page.locator('#port-choose').waitFor();
  await page.locator('#on').click();
  await page.locator('#refusal', { hasText: 'refused, the port is gone' }).waitFor();
  // Its heartbeat is missing for longer than it goes on without.
  await new Promise((done) => setTimeout(done, 1_000));
  // As another port, which has to be chosen.
  robot.info = { usbVendorId: 0x1A86, usbProductId: 0x7523 };
  robot.plug();
  await page.locator('#port-choose').click();
  await says('port USB 1a86:7523 is back');
  await page.locator('#port-name', { hasText: 'port USB 1a86:7523' }).waitFor();
  await connected();
  await isArmed(false);
  assert.equal((await state()).robot.fault !== null, true);
  assert.equal(await page.locator('#port-choose').isVisible(), false);
  await page.locator('#clear-fault').click();
  await page.locator('#on').click();
  await isArmed(true);
});

test('back in the lab the robot is stopped, its recording is saved, and the lab goes on', { skip }, async () => {
  const saved = page.waitForEvent('download');
  await page.locator('#port-end').click();
  const download = await saved;
  assert.match(download.suggestedFilename(), /^\d{8}-\d{6}-robot\.mcap$/);
  const path = join(folder(), download.suggestedFilename());
  await download.saveAs(path);
  // A whole log: the mark of MCAP is at both ends.
  const bytes = readFileSync(path);
  assert.deepEqual([bytes.subarray(0, 8), bytes.length > 10_000], [bytes.subarray(-8), true]);
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state()?.simulated);
  assert.equal(await page.locator('#robot-port').isVisible(), false);
  await page.locator('#simulation').waitFor();
  const { t_s } = await state();
  await page.waitForFunction((t_s) => /** @type {any} */ (window).rumbo.state().t_s > t_s, t_s);
  // The robot, looked at once more, was stopped by order.
  await page.locator('#real-robot').click();
  await page.locator('#port-connect').click();
  await page.locator('#port-name').waitFor();
  await connected();
  const { robot: { armed, fault } } = await state();
  assert.deepEqual([armed, fault], [false, null]);
  // Also without its port.
  robot.unplug();
  await page.locator('#port-choose').waitFor();
  await page.locator('#port-end').click();
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state()?.simulated);
  robot.plug();
});

test('dialog and port line speak Spanish, and are accessible', { skip }, async (context) => {
  const robot = await startRobot();
  context.after(() => robot.close());
  const here = await open({ locale: 'es-ES' }, '', '', robot);
  const { page } = here;
  const says = (/** @type {RegExp} */ text) => page.locator('#events li', { hasText: text }).first().waitFor();
  try {
    await page.waitForSelector('#connection.good');
    await page.locator('#real-robot').click();
    await page.locator('#flash summary').click();
    assert.deepEqual(await violations(page), [], 'dialog');
    await page.locator('#port-connect').click();
    await page.locator('#port-name', { hasText: 'puerto USB 2341:0042' }).waitFor();
    await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state()?.link.connected);
    robot.unplug();
    await says(/el puerto USB 2341:0042 ya no está/);
    await page.locator('#port-choose').waitFor();
    assert.deepEqual(await violations(page, '#robot-port'), [], 'port');
    robot.plug();
    await says(/el puerto USB 2341:0042 ha vuelto/);
    await page.locator('#port-end').click();
    await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state()?.simulated);
    // The reason that a port is gone is the browser's own.
    const left = (await page.evaluate(() => /** @type {any} */ (window).rumbo.untranslated())).filter((/** @type {string} */ text) => !/device has been lost/.test(text));
    assert.deepEqual(left, []);
  } finally {
    await here.close();
  }
});

test('a program is written to a Mega and read back; one for another chip and a lost cable are reported', { skip: noSite }, async () => {
  const board = new BootLoader();
  const port = new SerialRobot(board);
  const here = await open({}, '', '', port);
  const { page } = here;
  const says = (/** @type {string} */ text) => page.locator('#flash .complaint', { hasText: text }).waitFor();
  /** @param {string} name @param {string} text */
  const choose = (name, text) => page.locator('#flash input[type="file"]').setInputFiles({ name, mimeType: 'text/plain', buffer: Buffer.from(text) });
  await page.waitForSelector('#connection.good');
  await page.locator('#real-robot').click();
  await page.locator('#flash summary').click();
  const carried = join(process.env['SITE'] ?? '', 'rumbo.hex');
  if (existsSync(carried)) {
    const own = bytesOf(readFileSync(carried, 'utf8'));
    await page.locator('#flash-write').click();
    // A thousand messages to and fro, each a request here.
    await page.locator('#flash-phase', { hasText: 'done: the robot starts again, disarmed' }).waitFor({ timeout: 2 * PATIENCE_MS });
    assert.ok(board.flash.subarray(0, own.length).equals(own));
    board.resets = 0;
  } else {
    assert.ok(await page.locator('#flash-write').isDisabled());
  }
  await choose('mine.hex', hex(wanted));
  await page.locator('#flash-phase', { hasText: 'done' }).waitFor({ state: 'hidden' });
  await page.locator('#flash-write').click();
  await page.locator('#flash-phase', { hasText: 'done: the robot starts again, disarmed' }).waitFor();
  assert.deepEqual([...board.flash.subarray(0, wanted.length)], wanted);
  assert.deepEqual([board.resets, port.baud], [2, 115_200]);
  if (process.env['SCREENSHOT_FLASH']) await page.screenshot({ path: process.env['SCREENSHOT_FLASH'] });
  await choose('notes.hex', 'no program');
  await page.locator('#flash-write').click();
  await says('notes.hex: neither an ELF file nor Intel HEX');
  board.signature = [0x1E, 0x95, 0x0F];
  await choose('mine.hex', hex(wanted));
  await page.locator('#flash-write').click();
  await says('signature 1e950f, an ATmega2560 has 1e9801');
  board.signature = [0x1E, 0x98, 0x01];
  const { write } = board;
  // The cable goes with the fourth page.
  let pages = 0;
  board.write = function (bytes) {
    pages += Number(bytes[5] === 0x13);
    if (pages < 4) write.call(this, bytes);
    else port.unplug();
  };
  await page.locator('#flash-write').click();
  await says('The board has no complete program now, and does nothing until one is written');
  assert.deepEqual([...board.flash.subarray(0, 4)], [0xFF, 0xCF, 0xFF, 0xCF]);
  // The lab goes on beside it.
  assert.equal((await page.evaluate(() => /** @type {any} */ (window).rumbo.state())).simulated, true);
  await here.close();
});

test('a browser without serial ports says which one has them', { skip: noSite }, async () => {
  const here = await open({ locale: 'es-ES' });
  await here.page.addInitScript(() => { delete (/** @type {any} */ (Navigator.prototype)).serial; });
  await here.page.reload();
  await here.page.waitForSelector('#connection.good');
  await here.page.locator('#real-robot').click();
  await here.page.locator('#port-missing', { hasText: 'Chrome, Edge' }).waitFor();
  assert.equal(await here.page.locator('#port-connect').count(), 0);
  assert.deepEqual(await here.page.evaluate(() => /** @type {any} */ (window).rumbo.untranslated()), []);
  await here.close();
});

test('nothing is loaded from elsewhere, and no script complains', { skip }, () => {
  assert.deepEqual(site.abroad, []);
  // The browser itself reports the requests that the stand-in's unplugged port refuses.
  assert.deepEqual(site.complaints.filter((text) => !/Failed to load resource|net::ERR/.test(text)), []);
});
