// @ts-check
/** Parts of the page with messages made for them, in a page that is there for its language and its elements. */
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { folder, open } from '../dashboard.mjs';

/** @type {Awaited<ReturnType<typeof open>>} */
let dashboard;
/** @type {import('playwright-core').Page} */
let page;

before(async () => {
  dashboard = await open(['lab', '--scenario', 'mode1', '--out', folder()]);
  page = dashboard.page;
  await page.waitForSelector('#connection.good');
});

after(() => dashboard?.close());

/** What the calibration's page says after each of these states, and what it sends when the old values are put back. @param {unknown[]} calibrations */
const calibrated = (calibrations) => page.evaluate(async ({ calibrations, module }) => {
  /** @type {unknown[]} */
  const sent = [];
  const view = new (await import(module)).CalibrationDialog((/** @type {unknown} */ order) => sent.push(order));
  view.setParameters([{ id: 3, name: 'base_m', value: null }]);
  view.open();
  const body = [...document.querySelectorAll('#calibration-step')].at(-1);
  const seen = calibrations.map((calibration) => {
    view.show({ t_s: 1, simulated: true, calibration });
    return /** @type {HTMLElement} */ (body).innerText;
  });
  /** @type {HTMLButtonElement | undefined} */ ([...body?.querySelectorAll('button') ?? []].find(({ textContent }) => textContent === 'Put the old values back'))?.click();
  body?.closest('dialog')?.remove();
  return { seen, sent };
}, { calibrations, module: '/src/calibration_dialog.js' });

test('a calibration shows the values before, whether or not the page had read them, and puts them back', async () => {
  const findings = { rows: [{ name: 'distance between the wheels [m]', found: 0.0987, standard_error: null }], parameters: [[3, 0.0987]], before: [[3, 0.1]] };
  const { seen, sent } = await calibrated([{ number: 1, phase: 'running', since_s: 0 }, { number: 1, phase: 'done', findings }]);
  assert.match(seen[1] ?? '', /base_m\s+0\.1\s+0\.0987/);
  assert.deepEqual(sent, [{ type: 'set_param', id: 3, value: 0.1 }]);
});

test('a calibration that ends as the one before is shown, and one that a reset took away is over', async () => {
  const failed = (/** @type {number} */ number, /** @type {string} */ why) => ({ number, phase: 'failed', why });
  const { seen } = await calibrated([failed(1, 'first'), failed(2, 'second'), { number: 3, phase: 'running', since_s: 0 }, undefined, failed(4, 'fourth')]);
  assert.deepEqual(seen.map((text) => text.match(/first|second|fourth|Stay out of its way|Begin the calibration/)?.[0]), ['first', 'second', 'Stay out of its way', 'Begin the calibration', 'fourth']);
});

test('a search begins with what the robot has, though its values come after the dialog was opened', async () => {
  await page.locator('#tune').click();
  const offered = page.locator('#tune-parameters label', { hasText: 'front_kp' });
  await offered.waitFor();
  const before = await offered.innerText();
  await page.locator('#tune-dialog').getByRole('button', { name: 'Close' }).click();
  const field = page.locator('#parameter-front_kp');
  await field.fill('1.5');
  await page.locator('#tune').click();
  await offered.waitFor();
  assert.equal(await offered.innerText(), before);
  await field.evaluate((field) => field.dispatchEvent(new KeyboardEvent('keydown', { key: 'Enter' })));
  await page.locator('#tune-parameters label', { hasText: /front_kp\s+1\.5\s/ }).waitFor();
  await page.keyboard.press('Escape');
});

/** A judgement of the page's. @param {string} name @param {unknown[]} values @returns {Promise<any>} */
const judged = (name, ...values) => page.evaluate(async ({ name, values, module }) => (await import(module))[name](...values), { name, values, module: '/src/checkup.js' });

test('each pair of what was counted and what was seen has its remedy', async () => {
  for (const [count, seen, remedy] of [
    ['own', 'backward', /left wheel turns backward\. Swap the two wires of its motor/], ['other', 'forward', /two encoders are exchanged/], ['other', 'other', /two motors are exchanged/],
    ['own', 'other', /Motors and encoders are both exchanged/], ['none', 'forward', /left encoder is silent/], ['none', 'none', /left wheel does not turn/], ['own', 'none', /picks up noise/],
    ['both', 'forward', /Both encoders count/],
  ]) {
    const verdict = await judged('judgeMotor', 'left', count, seen);
    assert.equal(verdict.good, false);
    assert.match(verdict.text, /** @type {RegExp} */ (remedy));
  }
  assert.equal((await judged('judgeMotor', 'right', 'own', 'forward')).good, true);
  assert.deepEqual([await judged('counted', 'left', 80, 0), await judged('counted', 'right', 80, 0), await judged('counted', 'left', 1, 2), await judged('counted', 'left', 50, 50)], ['own', 'other', 'none', 'both']);
});

test('ten turns by hand tell edges and gears', async () => {
  const turns = await judged('turned', [0, 1, 2, 3], [0, 60, -120, 60], 1);
  assert.equal(turns, 4, 'whichever way');
  assert.equal((await judged('judgeTurns', 'left', 10.3)).good, true);
  assert.match((await judged('judgeTurns', 'right', 5)).text, /right wheel gives some 192 edges, and the program counts with 384/);
  assert.match((await judged('judgeTurns', 'right', 0)).text, /right encoder is silent/);
});

test('a hand before a sonar is found, also by the wrong one', async () => {
  assert.equal((await judged('judgeSonar', 0, [20, 'clear', 150], ['clear', 'clear', 150])).good, true);
  assert.match((await judged('judgeSonar', 0, ['clear', 150, 20], ['clear', 150, 180])).text, /front sonar sees the hand instead of the left one\. Swap/);
  assert.equal(await judged('judgeSonar', 0, ['clear', 15, 150], ['clear', 15, 150]), null, 'what stood there before is no hand');
  assert.match((await judged('sonarInVain', 1, null)).text, /right sonar gives no reading/);
});

test('another robot has the same colour on every page, and its name is not behind the readout', async () => {
  const seen = await page.evaluate(async ([map, store]) => {
    const { WorldMap } = await import(/** @type {string} */ (map));
    const { Store } = await import(/** @type {string} */ (store));
    const canvas = document.createElement('canvas');
    document.querySelector('#map-section')?.append(canvas);
    Object.assign(canvas.style, { position: 'absolute', inset: '0', width: '100%', height: '100%' });
    const kept = new Store();
    const view = new WorldMap(canvas, kept, () => {});
    const footprint_m = [[-0.1, -0.1], [0.1, -0.1], [0.1, 0.1]];
    view.setScene({ obstacles: [], others: ['a', 'c'].map((name) => ({ name, footprint_m })), footprint_m, start: { x_m: 0, y_m: 0, heading_rad: 0 } });
    view.own = 1;
    view.fit();
    // The one high up, the other below.
    const names = ['a', 'c'].flatMap((name) => ['x_m', 'y_m', 'heading_deg'].map((part) => `${name}_${part}`));
    kept.readings.push({ source: 'others', names, rows: [[0, [0, 1.5, 0, 0, -1.5, 0]]] });
    /** @type {Record<string, number>} */
    const heights = {};
    const { fillText } = CanvasRenderingContext2D.prototype;
    const readout = /** @type {HTMLElement} */ (document.querySelector('#pose'));
    readout.textContent = 'x\ny';
    const low = readout.offsetTop + readout.offsetHeight;
    CanvasRenderingContext2D.prototype.fillText = /** @this {CanvasRenderingContext2D} @param {string} text @param {number} x @param {number} y */ function (text, x, y) {
      heights[text] = this.getTransform().f / devicePixelRatio + y;
      fillText.call(this, text, x, y);
    };
    view.draw();
    const fitted = heights['a'] ?? 0;
    // Nearer, where the readout would be over its name.
    canvas.dispatchEvent(new KeyboardEvent('keydown', { key: '+' }));
    view.draw();
    const zoomed = (heights['a'] ?? 0) - view.worldToCanvas([0, 1.5])[1];
    CanvasRenderingContext2D.prototype.fillText = fillText;
    canvas.remove();
    return { numbers: view.others().map((/** @type {any} */ { number }) => number), low, fitted, zoomed };
  }, ['/src/map.js', '/src/store.js']);
  assert.deepEqual(seen.numbers, [0, 2]);
  assert.ok(seen.fitted > seen.low + 6 && seen.zoomed > 0, JSON.stringify(seen));
});

test('where places are picked the robot is large, and so near that its goal is in sight', async () => {
  const seen = await page.evaluate(async ([map, store]) => {
    const { WorldMap } = await import(/** @type {string} */ (map));
    const { Store } = await import(/** @type {string} */ (store));
    const canvas = document.createElement('canvas');
    document.body.append(canvas);
    Object.assign(canvas.style, { position: 'absolute', inset: '0', width: '600px', height: '400px' });
    const view = new WorldMap(canvas, new Store(), () => {});
    view.setScene({ obstacles: [{ corners_m: [[-4, -4], [6, 4]], closed: false }], footprint_m: [[-0.1, -0.1], [0.1, 0.1]], start: { x_m: 0, y_m: 0, heading_rad: 0 } });
    view.setPick(() => {});
    const places = [1.5, 5].map((goal) => {
      view.setTask({ goal: [goal, 0] });
      return [[-0.1, 0], [0.1, 0], [goal, 0]].map((at) => view.worldToCanvas(at)[0]);
    });
    canvas.remove();
    return places;
  }, ['/src/map.js', '/src/store.js']);
  for (const [left = 0, right = 0, goal = 0] of seen) assert.ok(left > 0 && goal < 600 && right > left, JSON.stringify(seen));
  const [[left, right] = [], far = []] = seen;
  assert.ok(right - left > 39.9 && far[1] - far[0] < 39, JSON.stringify(seen));
});

test('the scale of the map is drawn over its walls, and a state too short for its name has the beginning of it', async () => {
  const { last, names } = await page.evaluate(async ([map, store, band]) => {
    const { WorldMap } = await import(/** @type {string} */ (map));
    const { Store } = await import(/** @type {string} */ (store));
    const { StateBand } = await import(/** @type {string} */ (band));
    const canvas = document.createElement('canvas');
    const kept = new Store();
    const view = new WorldMap(canvas, kept, () => {});
    view.setScene({ obstacles: [{ corners_m: [[1, -1], [1, 1]], closed: false }], footprint_m: [[-0.1, -0.1], [0.1, -0.1], [0.1, 0.1]], start: { x_m: 0, y_m: 0, heading_rad: 0 } });
    /** @type {string[]} */
    const drawn = [];
    const { stroke, fillText } = CanvasRenderingContext2D.prototype;
    Object.assign(CanvasRenderingContext2D.prototype, {
      stroke: () => drawn.push('line'),
      fillText: (/** @type {string} */ text) => drawn.push(text),
    });
    view.draw();
    const last = drawn.at(-1);
    drawn.length = 0;
    kept.stretches = [[0, 8], [8, 10], [10, 10.2]].map(([from_s, to_s]) => ({ from_s, to_s, mode: 8, state: 0, armed: true, faulted: false }));
    new StateBand(kept, { range_s: [0, 20], mark_s: null, rightAxis: false, modes: [{ id: 8, states: ['advance along the obstacle'] }], label: () => {} }).draw();
    const names = drawn.filter((each) => each !== 'line' && !/ s$/.test(each));
    Object.assign(CanvasRenderingContext2D.prototype, { stroke, fillText });
    return { last, names };
  }, ['/src/map.js', '/src/store.js', '/src/band.js']);
  assert.match(last ?? '', /^[\d.]+ m$/);
  assert.deepEqual(names, ['state', '8: advance along the obstacle', 'advan…']);
});
