// @ts-check
/** The dashboard on the real lab. SCREENSHOT is a file for a picture of the page. */
import assert from 'node:assert/strict';
import { request } from 'node:http';
import { after, before, test } from 'node:test';
import { eventually, folder, open, rare } from '../dashboard.mjs';

/** @typedef {{series: (name: string) => {t: number[], y: (number | null | undefined)[]}, state: () => import('../../src/types.js').State | null}} Rumbo */

/** Below this a wheel stands [rpm]. */
const STANDING_RPM = 3;

/** @type {Awaited<ReturnType<typeof open>>} */
let dashboard;
/** @type {import('playwright-core').Page} */
let page;

before(async () => {
  dashboard = await open(['lab', '--speed', '8', '--out', folder()]);
  page = dashboard.page;
});

after(() => dashboard?.close());

/**
 * The last values plotted of a signal, gaps left out.
 * @param {string} name
 * @param {number} count
 */
function lastValues(name, count) {
  return page.evaluate(({ name, count }) => {
    const { y } = /** @type {any} */ (window).rumbo.series(name);
    return /** @type {number[]} */ (y.filter((/** @type {unknown} */ value) => typeof value === 'number').slice(-count));
  }, { name, count });
}

/** The sonar that looks ahead, by the rig. */
async function distanceName() {
  for (const name of ['range_front_cm', 'range_left_cm']) {
    if ((await lastValues(name, 1)).length > 0) return name;
  }
  throw new Error('no sonar reads anything');
}

/**
 * Waits until a signal's last second lies within a tolerance of a value, as plotted.
 * @param {string} name
 * @param {number} value
 * @param {number} tolerance
 */
function settles(name, value, tolerance) {
  return page.waitForFunction(({ name, value, tolerance }) => {
    const { y } = /** @type {any} */ (window).rumbo.series(name);
    const last = y.filter((/** @type {unknown} */ each) => typeof each === 'number').slice(-25);
    return last.length === 25 && last.every((/** @type {number} */ each) => Math.abs(each - value) <= tolerance);
  }, { name, value, tolerance });
}

/** @param {boolean} armed */
function isArmed(armed) {
  return page.waitForFunction((armed) => /** @type {any} */ (window).rumbo.state()?.robot.armed === armed, armed);
}

/** Waits until the wheels turn, as plotted. */
function wheelsTurn() {
  return page.waitForFunction((limit) => {
    const { y } = /** @type {any} */ (window).rumbo.series('left_rpm');
    return y.slice(-10).some((/** @type {number} */ each) => Math.abs(each) > limit);
  }, 4 * STANDING_RPM);
}

async function wheelsStand() {
  for (const side of ['left', 'right']) {
    await settles(`${side}_pwm`, 0, 0);
    await settles(`${side}_rpm`, 0, STANDING_RPM);
    await settles(`true_${side}_rpm`, 0, STANDING_RPM);
  }
}

/** @param {number} cm */
async function setReference(cm) {
  await page.locator('#reference-cm').fill(String(cm));
  await page.locator('#reference-cm').press('Enter');
}

test('the page connects, and the robot is not armed by it', async () => {
  await page.waitForSelector('#connection.good');
  await isArmed(false);
  await page.locator('#aim', { hasText: /^ON starts it/ }).waitFor();
  assert.deepEqual(await lastValues('left_pwm', 1), [0]);
  assert.equal(new URL(page.url()).search, '', 'the token does not stay in the address');
});

test('mode 1 holds 30 cm, and the distance follows the reference to 50 cm', async () => {
  // The lab begins in the scenario's mode.
  await page.waitForSelector('#reference-cm');
  await setReference(30);
  await page.locator('#on').click();
  await isArmed(true);
  const distance = await distanceName();
  await settles(distance, 30, 2);
  await setReference(50);
  await settles('reference_cm', 50, 0.1);
  await settles(distance, 50, 2);
  if (process.env['SCREENSHOT']) await page.screenshot({ path: process.env['SCREENSHOT'] });
});

/** Starts a scenario again, paused or not as before. @param {string} scenario */
async function startScenario(scenario) {
  await page.locator('#scenario').selectOption(scenario);
  await page.waitForFunction((scenario) => [...document.querySelectorAll('#events li')][0]?.textContent?.includes('acknowledged')
    && [...document.querySelectorAll('#events li')].some((line) => line.textContent?.includes(`reset: ${scenario}, `)), scenario);
}

/** Clicks the map at a place from the robot's origin [m]. @param {[number, number]} at */
async function clickMap(at) {
  // Once the panels have found their places, and with them the view.
  const [x, y] = await page.evaluate(async (at) => {
    const place = () => /** @type {[number, number]} */ (/** @type {any} */ (window).rumbo.onMap(at));
    let last = place();
    for (let still = 0, frames = 0; still < 10 && frames < 120; frames += 1) {
      await new Promise(requestAnimationFrame);
      const now = place();
      still = now.every((value, axis) => value === last[axis]) ? still + 1 : 0;
      last = now;
    }
    return last;
  }, at);
  await page.locator('#map').click({ position: { x, y } });
}

/** @typedef {NonNullable<ReturnType<Rumbo['state']>>['robot']['task']} Task */

/** @returns {Promise<Task>} */
function task() {
  return page.evaluate(() => /** @type {any} */ (window).rumbo.state().robot.task);
}

/** The states of the armed robot in a mode, one after the other. @param {number} mode @returns {Promise<number[]>} */
const states = (mode) => page.evaluate((mode) => /** @type {any} */ (window).rumbo.stretches()
  .filter((/** @type {any} */ each) => each.armed && each.mode === mode).map((/** @type {any} */ { state }) => state), mode);

/** At this many times real time from here on. @param {number} factor */
async function speed(factor) {
  await page.locator('#speed').selectOption(String(factor));
  await page.waitForFunction((factor) => /** @type {any} */ (window).rumbo.state().speed === factor, factor);
}

test('STOP stops the wheels, by the button and by Space from anywhere', async () => {
  // So that it is on its way when STOP comes.
  await speed(1);
  await setReference(30);
  await wheelsTurn();
  await page.locator('#stop').click();
  await isArmed(false);
  await wheelsStand();

  await page.locator('#on').click();
  await isArmed(true);
  // The robot may have got there before STOP.
  await setReference(80);
  await wheelsTurn();
  await page.locator('#reference-cm').focus();
  await page.keyboard.press('Space');
  await isArmed(false);
  await wheelsStand();
  await speed(8);
});

test('mode 5 turns the wheels at the speed asked for', async () => {
  await page.getByRole('button', { name: 'wheel speed' }).click();
  await page.locator('#reference-left-rpm').fill('-40');
  await page.locator('#reference button').click();
  await page.locator('#on').click();
  await settles('left_rpm', -40, 8);
  await settles('right_rpm', -40, 8);
  await page.locator('#off').click();
  await isArmed(false);
  await wheelsStand();
});

test('a parameter is written and held, and a value out of range is refused with the reason', async () => {
  const input = page.locator('#parameter-link_timeout_s');
  await page.waitForFunction(() => /** @type {HTMLInputElement | null} */ (document.querySelector('#parameter-link_timeout_s'))?.value !== '');
  await input.fill('0.3');
  await input.press('Enter');
  await page.waitForFunction(() => [...document.querySelectorAll('#events li')].some((line) => line.textContent?.includes('link_timeout_s = 0.3: acknowledged')));
  const row = page.locator('#parameters tr', { has: input });
  const told = input.evaluate((/** @type {HTMLInputElement} */ field) => new Promise((done) => { field.addEventListener('invalid', () => done(field.validationMessage), { once: true }); }));
  await input.fill('soon');
  await input.press('Enter');
  assert.match(String(await told), /^a number from 0/);
  await input.fill('99');
  await input.press('Enter');
  await page.locator('#why-link_timeout_s', { hasText: 'refused: allowed is' }).waitFor();
  assert.equal(await input.inputValue(), '99', 'it stays to be corrected');
  await row.getByRole('button', { name: 'Revert' }).click();
  assert.equal(await input.inputValue(), '0.3');
  // A switch stands as the robot has it.
  await page.getByLabel('all modes').check();
  await page.waitForFunction(() => /** @type {HTMLInputElement | null} */ (document.querySelector('#parameter-mission_reset_origin'))?.checked);
  await page.getByLabel('all modes').uncheck();
});

rare('the view held still loses no data', async () => {
  await page.locator('#pause').click();
  const { t: before } = await page.evaluate(() => /** @type {any} */ (window).rumbo.series('left_pwm'));
  await page.waitForFunction((count) => /** @type {any} */ (window).rumbo.series('left_pwm').t.length > count + 25, before.length);
  await page.locator('#live').click();
  const { t } = await page.evaluate(() => /** @type {any} */ (window).rumbo.series('left_pwm'));
  const gaps = t.slice(1).map((/** @type {number} */ each, /** @type {number} */ index) => each - t[index]);
  assert.ok(Math.max(...gaps) < 0.5, `a gap of ${Math.max(...gaps)} s`);
});

test('mode 8: a click on the map sets the goal, which stands where the click was', async () => {
  await startScenario('mode8-random');
  await page.waitForSelector('#goal');
  await clickMap([0.6, 0.2]);
  await page.waitForFunction(() => Math.abs((/** @type {any} */ (window).rumbo.state().robot.task.goal?.[0] ?? 9) - 0.6) < 0.02);
  const { goal } = await task();
  assert.ok(goal && Math.abs(goal[1] - 0.2) < 0.02, String(goal));
  await page.waitForFunction(() => /goal \(0\.[56]\d*, 0\.[12]\d*\) m, 0\.6\d m away/.test(document.querySelector('#aim')?.textContent ?? ''));

  await page.getByRole('button', { name: '(0.5, −0.5)' }).click();
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state().robot.task.goal?.[1] === -0.5);
  await page.locator('#goal-x').fill('19.5');
  await page.locator('#goal-y').fill('-2');
  await page.locator('#goal button').click();
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state().robot.task.goal?.[0] === 19.5);
  await page.locator('#lane').click();
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state().robot.task.lane);
});

test('mode 7: a route made by clicks, the first as soon as its world is there, is driven by ON, point by point', async () => {
  // Before the robot has taken the mode; Enter takes the middle of the map.
  await page.evaluate(() => new MutationObserver((_changes, observer) => {
    observer.disconnect();
    document.getElementById('map')?.dispatchEvent(new KeyboardEvent('keydown', { key: 'Enter' }));
  }).observe(document.head, { subtree: true, childList: true }));
  await startScenario('mode7');
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state().robot.task.route?.waypoints.length === 4);
  await page.locator('.place').click();
  await clickMap([0.3, 0]);
  await clickMap([0.3, 0.3]);
  await eventually(async () => assert.deepEqual(await page.locator('.place b').allTextContents(), ['1', '2']));
  await clickMap([-1, -1]);
  await page.locator('.place').nth(2).click();
  // A page that comes too late for a sample loses it.
  await speed(2);
  await page.locator('#on').click();
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state().robot.task.route?.waypoints.length === 2);
  await page.waitForFunction(() => document.querySelector('#end')?.textContent === 'reached');
  const seen = await states(7);
  // 1 turns, 2 drives; where it waits between them is short, and may fall between two samples.
  assert.match(seen.join(), /2.*1.*2/, 'drive, turn, drive');
  await speed(8);
  const [x] = await lastValues('x_m', 1);
  const [y] = await lastValues('y_m', 1);
  assert.ok(x !== undefined && y !== undefined && Math.hypot(x - 0.3, y - 0.3) < 0.1, `${x}, ${y}`);
  await page.locator('#off').click();
  await isArmed(false);
});

test('mode 0: an arrow key drives while it is held, and losing the focus stops', async () => {
  await startScenario('free');
  await page.locator('#on').click();
  await isArmed(true);
  await page.keyboard.down('ArrowUp');
  await wheelsTurn();
  await page.keyboard.up('ArrowUp');
  await settles('left_pwm', 0, 0);
  await page.keyboard.down('ArrowLeft');
  await wheelsTurn();
  await page.locator('#level').focus();
  await settles('left_pwm', 0, 0);
  await page.keyboard.up('ArrowLeft');
  await page.locator('#off').click();
  await isArmed(false);
});

test('parameters saved on the robot are still there when it starts again', async () => {
  await page.locator('#parameter-link_timeout_s').fill('0.35');
  await page.locator('#parameter-link_timeout_s').press('Enter');
  await page.locator('#save-parameters').click();
  await page.waitForSelector('#events :text("parameters saved on the robot")');
  await page.locator('#simulation button[type=submit]').click();
  await page.waitForSelector('#events :text("from the second copy")');
  await page.waitForFunction(() => /** @type {HTMLInputElement} */ (document.querySelector('#parameter-link_timeout_s')).value === '0.35');
  await page.locator('#reset-parameters').click();
  await page.waitForFunction(() => /** @type {HTMLInputElement} */ (document.querySelector('#parameter-link_timeout_s')).value === '0.4');
});

rare('a sensor layout that the robot does not carry is warned about, and the robot can be updated', async () => {
  await page.locator('#rig').selectOption('front_single');
  await page.locator('#simulation button[type=submit]').click();
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state().robot.rig === 'front_single');
  await eventually(async () => assert.equal(await page.locator('#rig-warning').isVisible(), false));
  await page.locator('#reset-parameters').click();
  await page.waitForSelector('#rig-warning');
  assert.match(await page.locator('#rig-text').innerText(), /is set to the sensor layout final, but front_single is mounted/);
  await page.locator('#rig-tell').click();
  await page.waitForSelector('#rig-warning', { state: 'hidden' });
});

rare('each mode has its controls, and nothing moves when the mode changes', async () => {
  /** @type {Record<string, string>} */
  const controls = {
    0: '#movements', 1: '#reference-cm', 2: '#reference-cm', 3: '#about', 4: '#reference-cm', 5: '#reference-left-rpm', 6: '#reference-rpm',
    7: '#route-set', 8: '#lane',
  };
  /** @type {number[][]} */
  const places = [];
  for (const [mode, selector] of Object.entries(controls)) {
    await page.locator(`#modes button[value="${mode}"]`).click();
    await page.waitForFunction((mode) => String(/** @type {any} */ (window).rumbo.state().robot.mode) === mode, mode);
    await page.waitForSelector(selector);
    assert.ok(await page.locator('#state').innerText(), 'the state line says something');
    const { x = 0, y = 0, width = 0, height = 0 } = await page.locator('#on').boundingBox() ?? {};
    places.push([x, y, width, height]);
  }
  // Lines of text are not whole pixels high.
  const moved = places.map((place) => Math.max(...place.map((each, side) => Math.abs(each - (places[0]?.[side] ?? NaN)))));
  assert.ok(Math.max(...moved) < 1, JSON.stringify(places));
});

test('scenarios have titles below groups, and one that is chosen is loaded, disarmed', async () => {
  const menu = await page.locator('#scenario').evaluate((select) => [.../** @type {HTMLSelectElement} */ (select).querySelectorAll('optgroup')].map((group) => [group.label, ...[...group.querySelectorAll('option')].map(({ textContent }) => textContent)]));
  assert.deepEqual(menu[2], ['Mode 1: front distance', 'Stop at a distance from a wall, 107 → 30 → 50 cm', 'Stop at a distance from a wall, 107 → 30 → 50 cm, on the final rig']);
  assert.ok(menu.length <= 13, `${menu.length} groups`);
  await startScenario('mode1');
  await page.locator('#on').click();
  await isArmed(true);
  await page.locator('#scenario').selectOption('mode5');
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state()?.robot.mode === 5);
  await isArmed(false);
});

test('a reset starts again with the seed asked for', async () => {
  // At eight times that, a slow page would first look when more than 5 s are over.
  await speed(1);
  await page.locator('#seed').fill('7');
  await page.locator('#simulation button[type=submit]').click();
  await page.waitForFunction(() => [...document.querySelectorAll('#events li')].some((line) => line.textContent?.includes('seed 7')));
  await page.waitForFunction(() => {
    const { t } = /** @type {any} */ (window).rumbo.series('left_pwm');
    return t.length > 0 && t.at(-1) < 5 && t[0] < 1;
  });
  assert.equal(await page.locator('#seed').inputValue(), '7');
  await speed(8);
});

rare('a page of another origin gets no WebSocket', async () => {
  const key = await page.evaluate(() => localStorage.getItem('rumbo.key'));
  for (const [origin, expected] of [['http://evil.example', 403], [new URL(dashboard.url).origin, 101]]) {
    /** @type {number | undefined} */
    const status = await new Promise((resolve, reject) => {
      const asked = request(new URL('/ws', dashboard.url), {
        headers: {
          Origin: String(origin), Connection: 'Upgrade', Upgrade: 'websocket', 'Sec-WebSocket-Version': '13',
          'Sec-WebSocket-Key': 'AAAAAAAAAAAAAAAAAAAAAA==', 'Sec-WebSocket-Protocol': `rumbo, ${key}`,
        },
      });
      asked.on('response', (answer) => resolve(answer.statusCode));
      asked.on('upgrade', (answer, socket) => {
        socket.destroy();
        resolve(answer.statusCode);
      });
      asked.on('error', reject);
      asked.end();
    });
    assert.equal(status, expected, String(origin));
  }
});

rare('garbage is refused with a reason and closed, while robot and page continue', async () => {
  const result = await page.evaluate(() => new Promise((resolve) => {
    const socket = new WebSocket(`ws://${location.host}/ws`, ['rumbo', localStorage.getItem('rumbo.key') ?? '']);
    /** @type {string[]} */
    const errors = [];
    socket.onopen = () => socket.send('garbage');
    socket.onmessage = (event) => {
      const message = JSON.parse(event.data);
      if (message.type === 'error') errors.push(message.text);
    };
    socket.onclose = (event) => resolve({ errors, code: event.code });
  }));
  const { errors, code } = /** @type {{errors: string[], code: number}} */ (result);
  assert.match(errors[0] ?? '', /not understood/);
  assert.equal(code, 1008);
  const [last] = await page.evaluate(() => /** @type {any} */ (window).rumbo.series('left_pwm').t.slice(-1));
  await page.waitForFunction((last) => /** @type {any} */ (window).rumbo.series('left_pwm').t.at(-1) > last + 1, last);
  await page.waitForSelector('#connection.good');
});

test('the browser has nothing to complain about', () => {
  assert.deepEqual(dashboard.complaints, []);
});
