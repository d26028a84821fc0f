// @ts-check
/** Who may do what: a viewer, two pages of controllers and the one lease of control between them. */
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { violations } from '../axe.mjs';
import { folder, open, showPage } from '../dashboard.mjs';

/** @typedef {import('playwright-core').Page} Page */

/** @type {Awaited<ReturnType<typeof open>>} */
let dashboard;
/** The first controller's page, the second's, and a viewer's. @type {Page} */
let first;
/** @type {Page} */
let second;
/** @type {Page} */
let viewer;

before(async () => {
  dashboard = await open(['lab', '--listen', '127.0.0.1', '--out', folder()]);
  first = dashboard.page;
  await first.waitForSelector('#connection.good');
  second = await showPage(first.context(), dashboard.url);
  const watching = await dashboard.browser.newContext({ viewport: { width: 1280, height: 720 }, locale: 'en-GB' });
  viewer = await showPage(watching, await dashboard.viewersUrl());
});

after(() => dashboard?.close());

/** @param {Page} page @param {string | RegExp} text */
const seatText = (page, text) => page.locator('#seat-words', { hasText: text }).waitFor();
/** @param {boolean} armed */
const isArmed = (armed) => first.waitForFunction((armed) => /** @type {any} */ (window).rumbo.state()?.robot.armed === armed, armed);

/** Sends an order as a script would that does not care for the page's buttons; what the station answers it. @param {Page} page @param {string} order */
function answer(page, order) {
  return page.evaluate((order) => new Promise((resolve) => {
    const socket = new WebSocket(`ws://${location.host}/ws`, ['rumbo', localStorage.getItem('rumbo.key') ?? '']);
    let sent = false;
    socket.addEventListener('message', ({ data }) => {
      if (!sent) socket.send(order);
      sent = true;
      const said = JSON.parse(data).events?.find((/** @type {{text: string}} */ each) => each.text.startsWith('refused'))?.text;
      if (!said) return;
      socket.close();
      resolve(said);
    });
  }), order);
}

test('the first order takes control, and every page shows which one has it', async () => {
  await seatText(first, 'this is page 1, nobody has control');
  await first.locator('#on').click();
  await isArmed(true);
  await seatText(first, 'this is page 1, it has control');
  await seatText(second, 'page 1 has control, this is page 2; STOP works');
  await seatText(viewer, 'you watch, page 1 has control; STOP works');
  // Telling it takes no room from what the robot does.
  for (const page of [second, viewer]) {
    const [panel, line] = await Promise.all(['#command-section', '#state-line'].map((part) => page.locator(part).boundingBox()));
    assert.ok(panel && line && line.y + line.height <= panel.y + panel.height, JSON.stringify([panel, line]));
  }
});

test('a page without control looks so, is refused with the reason where it was pressed, and may stop the robot', async () => {
  const faint = (/** @type {string} */ id) => second.locator(`#${id}`).evaluate((part) => getComputedStyle(part).borderStyle === 'dashed');
  for (const id of ['on', 'off', 'scenario', 'save-parameters']) assert.equal(await faint(id), true, id);
  assert.equal(await faint('stop'), false);
  assert.deepEqual(await violations(second), []);
  await second.locator('#off').click();
  const [said, button] = await Promise.all(['#nope', '#off'].map((part) => second.locator(part).boundingBox()));
  assert.equal(await second.locator('#nope').textContent(), 'refused: another page has control; take it first');
  assert.ok(said && button && Math.hypot(said.x - button.x, said.y - button.y - button.height) < 20, JSON.stringify([said, button]));
  assert.equal(await answer(second, '{"type":"disarm"}'), 'refused: another page has control; take it first');
  // The menu goes on showing what runs.
  await second.locator('#scenario').selectOption('mode5');
  assert.equal(await second.locator('#scenario').inputValue(), 'mode1');
  await second.locator('#stop').click();
  await isArmed(false);
  await seatText(second, 'page 1 has control, this is page 2');
});

test('control that is let go goes to the page that asks for it', async () => {
  await first.locator('#release-control').click();
  await seatText(second, 'this is page 2, nobody has control');
  await second.locator('#take-control').click();
  await seatText(second, 'this is page 2, it has control');
  await seatText(first, 'page 2 has control, this is page 1');
  await seatText(viewer, 'you watch, page 2 has control');
});

test('a page can take control from another on purpose', async () => {
  await first.locator('#take-control').click();
  await seatText(first, 'this is page 1, it has control');
  await seatText(second, 'page 1 has control, this is page 2');
});

test('a viewer can command nothing, neither by the page nor around it, and may stop the robot', async () => {
  await first.locator('#on').click();
  await isArmed(true);
  for (const id of ['command-section', 'parameter-section', 'simulation']) {
    assert.equal(await viewer.locator(`#${id}`).evaluate((part) => /** @type {HTMLElement} */ (part).inert), true, id);
  }
  for (const order of ['{"type":"arm"}', '{"type":"take_control"}', '{"type":"reference","value":1}', '{"type":"speed","factor":0}']) {
    assert.equal(await answer(viewer, order), 'refused: this page may watch, and stop the robot', order);
  }
  for (const id of ['take-control', 'on', 'controls', 'save-parameters']) assert.equal(await viewer.locator(`#${id}`).isVisible(), false, id);
  await viewer.locator('#stop').click();
  await isArmed(false);
});

test('control goes with the page that had it, and is free for another', async () => {
  await seatText(second, 'page 1 has control');
  await first.reload();
  await seatText(second, 'this is page 2, nobody has control');
  await second.locator('#on').click();
  await seatText(second, 'this is page 2, it has control');
  await second.locator('#stop').click();
  assert.deepEqual(dashboard.complaints, []);
});
