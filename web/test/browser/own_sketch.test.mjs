// @ts-check
/**
 * A person's own sketch in the lab: it drives though it sends no telemetry, an error is shown where it was saved, the mended
 * sketch runs, its console takes a line, its numbers are plotted; on a telephone too. Without a compiler there is nothing to
 * test.
 */
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { readFileSync, readdirSync, renameSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { folder, open, program, rare } from '../dashboard.mjs';

const sketch = join(folder(), 'mine');
const file = join(sketch, 'mine.ino');
const logs = folder();
const compiled = spawnSync('avr-gcc', ['--version']).status === 0;
const skip = compiled ? false : 'avr-gcc is missing';
if (skip && process.env['CI']) throw new Error(skip);

/** As many editors save: another file, renamed. @param {string} text */
function save(text) {
  writeFileSync(`${file}~`, text);
  renameSync(`${file}~`, file);
}

/** @type {Awaited<ReturnType<typeof open>>} */
let dashboard;
/** @type {import('playwright-core').Page} */
let page;

/** The last value of a signal. @param {string} name */
const last = (name) => page.evaluate((name) => /** @type {any} */ (window).rumbo.series(name).y.at(-1), name);
/** Waits until a signal's last value is in a range. @param {string} name @param {number} min @param {number} max */
const until = (name, min, max) => page.waitForFunction(([name, min, max]) => {
  const value = /** @type {any} */ (window).rumbo.series(name).y.at(-1);
  return typeof value === 'number' && value >= Number(min) && value <= Number(max);
}, [name, min, max]);

before(async () => {
  if (skip) return;
  assert.equal(spawnSync(program(), ['new', 'sketch', sketch]).status, 0);
  dashboard = await open(['lab', '--scenario', 'mode1', '--sketch', sketch, '--out', logs], { viewport: { width: 1280, height: 800 } });
  page = dashboard.page;
  await page.waitForSelector('body.own');
});

after(() => dashboard?.close());

test('a sketch without telemetry is seen to drive, and what it cannot serve is not shown', { skip }, async () => {
  await until('true_x_m', 0.2, 9);
  await until('pinged_front_cm', 1, 250);
  assert.equal(await page.locator('#parameter-section').isVisible(), false);
  assert.equal(await page.locator('#modes').isVisible(), false);
  assert.equal(await page.locator('#program-name').textContent(), 'mine');
  const ports = await page.locator('#console-choice button').allTextContents();
  assert.deepEqual(ports, ['Serial (USB)', 'Serial1 (Bluetooth)']);
});

test('STOP stops it whatever it does, the page says by what, and ON lets it go on', { skip }, async () => {
  const chip = page.locator('#armed');
  const text = readFileSync(file, 'utf8');
  save('#include <RumboRobot.h>\nRumboRobot robot;\nvoid setup() { robot.begin(); }\nvoid loop() { robot.drive(-80, -80); }\n');
  const renewed = page.locator('#events li', { hasText: 'the changed program runs' });
  await renewed.first().waitFor();
  await until('true_left_rpm', -300, -20);
  await page.keyboard.press('Space');
  await until('true_left_rpm', -0.1, 0.1);
  assert.equal(await chip.textContent(), 'motors without supply');
  await page.locator('#events', { hasText: 'STOP: the motors have no supply, whatever the program does' }).waitFor();
  await page.locator('#on').click();
  await chip.filter({ hasText: 'motors supplied' }).waitFor();
  await until('true_left_rpm', -300, -20);
  save(text);
  await renewed.nth(1).waitFor();
  await until('true_left_rpm', 20, 300);
});

rare('the tab Profile shows where its time goes, and its interrupts', { skip }, async () => {
  await page.getByRole('tab', { name: 'Profile' }).click();
  assert.equal(await page.locator('#profile-functions').isVisible(), false);
  await page.locator('#profile-run').click();
  const cells = (/** @type {import('playwright-core').Locator} */ row) => row.locator('th, td').allTextContents();
  // `pulseIn` waits for the echo, `delay` for the next round; timer 0 is the clock of both.
  const waits = page.locator('#profile-functions tbody tr').filter({ hasText: /pulseIn|countPulse|delay|micros/ });
  await waits.first().waitFor();
  const clock = page.locator('#profile-interrupts tbody tr', { hasText: 'TIMER0_OVF' });
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo.state().program.profile?.cycles > 16e6);
  const [, count, rate, , mean, longest] = (await cells(clock)).map((text) => Number(text.replace(/[^\d.]/g, '')));
  // Every 1,024 us.
  assert.ok(Number(count) > 900 && Math.abs(Number(rate) - 976.6) < 2, `${count} ${rate}`);
  assert.ok(Number(mean) > 20 && Number(mean) <= Number(longest) && Number(longest) < 400, `${mean} ${longest}`);
  await page.locator('#profile-run').click();
  await page.locator('#profile-functions').waitFor({ state: 'hidden' });
  await page.getByRole('tab', { name: 'Events' }).click();
});

rare('the numbers that it prints are plotted', { skip }, async () => {
  await page.locator('#console').filter({ hasText: /\d+\.\d\d/ }).waitFor();
  await page.locator('#console-plot').click();
  await page.locator('.plot-head').filter({ hasText: 'Serial (USB)' }).waitFor();
  const [names, values] = await page.evaluate(() => {
    const rumbo = /** @type {any} */ (window).rumbo;
    const own = rumbo.plots().layout.plots.find((/** @type {any} */ each) => each.title === 'Serial (USB)').signals;
    return [own, own.map((/** @type {string} */ name) => rumbo.series(name).y.filter((/** @type {unknown} */ y) => typeof y === 'number').length)];
  });
  assert.ok(names.length > 0 && values.every((/** @type {number} */ count) => count > 5), `${names} ${values}`);
  const picture = process.env['SCREENSHOT_SKETCH'];
  if (picture) await page.screenshot({ path: picture });
});

const starter = () => readFileSync(file, 'utf8');

test('an error that is saved stops the robot, and the page shows its file, its line and the line itself', { skip }, async () => {
  const good = starter();
  save(good.replace('void loop() {', 'void loop() {\n  sped = 3;'));
  const line = 1 + starter().split('\n').findIndex((text) => text.includes('sped'));
  const first = page.locator('#complaints li').first();
  await first.waitFor();
  assert.match(await first.textContent() ?? '', new RegExp(`mine\\.ino:${line}:3.*sped.*not declared.*sped = 3;`, 's'));
  assert.match(await page.locator('#connection').textContent() ?? '', /does not compile/);
  await until('true_left_pwm', 0, 0);
  await until('true_left_rpm', -1, 1);
  const picture = process.env['SCREENSHOT_SKETCH'];
  if (picture) await page.screenshot({ path: picture.replace('.png', '-error.png') });
});

test('on a telephone the error is read without scrolling sideways, and STOP stays in view', { skip }, async () => {
  await page.setViewportSize({ width: 390, height: 844 });
  assert.equal(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), true);
  await page.locator('#complaints li').first().scrollIntoViewIfNeeded();
  for (const top of [0, 400, 5_000]) {
    await page.evaluate((top) => scrollTo(0, top), top);
    const box = await page.locator('#stop').boundingBox();
    assert.ok(box && box.y >= 0 && box.y + box.height <= 844 && box.x + box.width <= 390, JSON.stringify(box));
  }
  const picture = process.env['SCREENSHOT_SKETCH'];
  await page.evaluate(() => scrollTo(0, 0));
  if (picture) await page.screenshot({ path: picture.replace('.png', '-phone.png'), fullPage: true });
  await page.setViewportSize({ width: 1280, height: 800 });
});

test('the mended sketch runs from the start, and drives when a line is typed to its console', { skip }, async () => {
  save(`const int OUTPUTS[] = {5, 6, 4, 7, 2, 8};
void setup() {
  for (int pin : OUTPUTS) pinMode(pin, OUTPUT);
  Serial.begin(115200);
  Serial1.begin(9600);
  Serial1.println("ready");
}
void loop() {
  if (Serial.readStringUntil('\\n') != "go") return;
  Serial.println("going");
  digitalWrite(4, HIGH);
  digitalWrite(7, HIGH);
  analogWrite(5, 120);
  analogWrite(6, 120);
}
`);
  const port = (/** @type {string} */ name) => page.locator('#console-choice button').filter({ hasText: name });
  await page.locator('#complaints').waitFor({ state: 'hidden' });
  await port('Serial1 (Bluetooth)').click();
  await page.locator('#console').filter({ hasText: /^ready/ }).waitFor();
  // It has said nothing here yet.
  await port('Serial (USB)').click();
  assert.equal(await page.locator('#complaints').isVisible(), false);
  assert.ok(Math.abs(await last('true_x_m')) < 0.01, 'it stands at the start again');
  await page.locator('#console-text').fill('go');
  await page.keyboard.press('Enter');
  await page.locator('#console').filter({ hasText: 'going' }).waitFor();
  await until('true_left_pwm', 110, 130);
  await until('true_x_m', 0.1, 9);
  assert.deepEqual(dashboard.complaints, []);
});

test('sessions, also that in which STOP cut the supply, run again byte for byte', { skip }, () => {
  // The last one goes on.
  const sessions = readdirSync(logs).filter((name) => name.endsWith('.mcap')).sort().slice(0, -1);
  assert.ok(sessions.length >= 3, sessions.join());
  for (const name of sessions) {
    const again = spawnSync(program(), ['rerun', join(logs, name)], { encoding: 'utf8' });
    assert.equal(again.status, 0, again.stdout + again.stderr);
  }
});

/** Drops a file on the page. @param {string} name @param {string} text */
const drop = (name, text) => page.evaluate(([name, text]) => {
  const dataTransfer = new DataTransfer();
  dataTransfer.items.add(new File([text ?? ''], name ?? ''));
  document.body.dispatchEvent(new DragEvent('drop', { dataTransfer, bubbles: true, cancelable: true }));
}, [name, text]);

const walled = spawnSync('bwrap', ['--ro-bind', '/', '/', 'true']).status === 0;

rare('a sketch that is dropped on the page is compiled in the sandbox and runs; what it may not include it does not get', { skip: skip || (walled ? false : 'bwrap is missing') }, async () => {
  await drop('dropped.ino', 'void setup() { Serial.begin(9600); Serial.println("dropped"); }\nvoid loop() {}\n');
  await page.locator('#console').filter({ hasText: /^dropped/ }).waitFor();
  assert.equal(await page.locator('#program-name').textContent(), 'dropped.ino');
  await drop('thief.ino', '#include "/etc/passwd"\nvoid setup() {}\nvoid loop() {}\n');
  await page.locator('#complaints li').first().filter({ hasText: /thief\.ino:1.*No such file/ }).waitFor();
  await drop('notes.txt', 'x');
  await page.locator('#events li').filter({ hasText: 'program: refused, only an .ino' }).waitFor();
});

rare('its log shows the same: replayed, and exported as tables', { skip }, async () => {
  await dashboard.close();
  const log = readdirSync(logs).sort().filter((name) => name.endsWith('.mcap'))[0] ?? '';
  const replay = await open(['replay', join(logs, log), '--speed', '4']);
  try {
    await replay.page.waitForFunction(() => {
      const rumbo = /** @type {any} */ (window).rumbo;
      return rumbo.series('true_x_m').y.at(-1) > 0.2 && rumbo.series('pin_left_enable').y.some((/** @type {number} */ y) => y > 0.2);
    });
    assert.deepEqual(replay.complaints, []);
  } finally {
    await replay.close();
  }
  const out = folder();
  assert.equal(spawnSync(program(), ['export', join(logs, log), '--out', out, '--format', 'csv']).status, 0);
  const tables = readdirSync(out);
  const read = (/** @type {string} */ ending) => readFileSync(join(out, tables.find((name) => name.endsWith(ending)) ?? ''), 'utf8').split('\n');
  assert.match(read('.instruments.csv')[0] ?? '', /^t_s,.*pin_left_enable.*true_x_m/);
  assert.ok(read('.printed0.csv').length > 10);
});
