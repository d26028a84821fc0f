// @ts-check
/**
 * Figures of the site for docs/browser.md: SITE=../site TOOLS=../target/release/rumbo-tools node test/site_bench.mjs. TOOLS is
 * the native program, `cargo build --release -p rumbo-tools`; avr-gcc compiles the program of the image. Times
 * of the processor hardly depend on what else the machine does; that of the first plot does.
 */
import { spawnSync } from 'node:child_process';
import { readFileSync, readdirSync } from 'node:fs';
import { join } from 'node:path';
import { gzipSync } from 'node:zlib';
import { runAvr8js, serveAvr8js } from './avr8js.mjs';
import { folder } from './dashboard.mjs';
import { open } from './site.mjs';

const FOLDER = process.env['SITE'] ?? '';
const LOADS = 5;
const TURNS = 4;
const SEEDS = 5;
/** What the scenario of the image lasts, and a little more for the image, which then ends. */
const SCENARIO = 'free';
const SCENARIO_S = 10;
const IMAGE_S = SCENARIO_S + 1;

/** @param {number[]} values */
const median = (values) => values.toSorted((one, other) => one - other)[Math.floor(values.length / 2)] ?? NaN;

/** Bytes of the site's files, compressed one by one. */
function compressed() {
  const files = readdirSync(FOLDER, { recursive: true, withFileTypes: true }).filter((entry) => entry.isFile());
  return files.reduce((sum, file) => sum + gzipSync(readFileSync(join(file.parentPath, file.name)), { level: 9 }).length, 0);
}

/** From the navigation to the first sample plotted, in a browser with an empty cache [ms]. */
async function firstPlot() {
  const { page, close } = await open();
  await page.waitForFunction(() => /** @type {any} */ (window).rumbo?.series('left_pwm').t.length > 0, null, { polling: 10 });
  const took = await page.evaluate(() => performance.now());
  await close();
  return took;
}

/** Share of a core that the lab takes at real time while the robot drives, its page apart. @param {import('playwright-core').Page} page */
const share = (page) => page.evaluate(async () => {
  const { default: init, Lab } = await import(new URL('lab/rumbo.js', location.href).href);
  await init();
  const lab = new Lab('{"scenario":"mode5"}');
  let busy_ms = 0;
  const begun_ms = performance.now();
  lab.order('{"type":"arm"}');
  while (performance.now() - begun_ms < 15_000) {
    const before_ms = performance.now();
    lab.advance();
    lab.news();
    busy_ms += performance.now() - before_ms;
    await new Promise((done) => setTimeout(done, 10));
  }
  return busy_ms / (performance.now() - begun_ms);
});

/** All headless runs. @param {import('playwright-core').Page} page */
const headless = (page) => page.evaluate(async (seeds) => {
  const { default: init, run_hash, scenarios } = await import(new URL('lab/rumbo.js', location.href).href);
  await init();
  for (const name of scenarios()) for (let seed = 1; seed <= seeds; seed++) run_hash(JSON.stringify({ scenario: name, seed }), new Uint8Array());
}, SEEDS);

/** The same natively: time of the processor [s]. */
function native() {
  const { stdout } = spawnSync('sh', ['-c', '"$TOOLS" hashes "$0" > /dev/null && times', String(SEEDS)], { encoding: 'utf8' });
  const [, minutes, seconds] = /\n(\d+)m([\d.]+)s/.exec(stdout) ?? [];
  return 60 * Number(minutes) + Number(seconds);
}

/** Time of the processor that the page with its lab takes meanwhile [s]. @param {import('playwright-core').Page} page @param {() => Promise<unknown>} work */
async function cpuTime(page, work) {
  const session = await page.context().browser()?.newBrowserCDPSession();
  const read = async () => {
    const { processInfo } = await session?.send('SystemInfo.getProcessInfo') ?? { processInfo: [] };
    return processInfo.filter(({ type }) => type === 'renderer').reduce((sum, { cpuTime }) => sum + cpuTime, 0);
  };
  const before = await read();
  await work();
  return await read() - before;
}

/** Two PID loops in floating point and odometry, a thousand times a second, waiting in between: as an image and as its bytes. */
function busy() {
  const [elf, flash] = ['busy.elf', 'busy.bin'].map((name) => join(made, name));
  const source = new URL('../../crates/emulator/tests/programs/busy.c', import.meta.url).pathname;
  const call = (/** @type {string} */ program, /** @type {string[]} */ options) => {
    const { status, error, stderr } = spawnSync(program, options, { encoding: 'utf8' });
    if (status !== 0) throw new Error(`${program}: ${error ?? stderr}`);
  };
  call('avr-gcc', ['-mmcu=atmega2560', '-Os', '-std=gnu11', '-DF_CPU=16000000UL', `-DSECONDS=${IMAGE_S}`, '-DHERTZ=1000', source, '-o', elf ?? '', '-lm']);
  call('avr-objcopy', ['-O', 'binary', elf ?? '', flash ?? '']);
  return { elf: readFileSync(elf ?? ''), flash: readFileSync(flash ?? '') };
}

/** The image with the robot, as a scenario. @param {import('playwright-core').Page} page @param {Buffer} image */
const emulated = (page, image) => page.evaluate(async ({ scenario, data }) => {
  const { default: init, run_hash } = await import(new URL('lab/rumbo.js', location.href).href);
  await init();
  run_hash(JSON.stringify({ scenario }), Uint8Array.from(atob(data), (each) => each.charCodeAt(0)));
}, { scenario: SCENARIO, data: image.toString('base64') });

const made = folder();
console.log(`compressed: ${(compressed() / 1e3).toFixed(0)} kB in all`);
/** @type {number[]} */
const loads = [];
for (let load = 0; load < LOADS; load++) loads.push(await firstPlot());
console.log(`first plot after a cold load: ${median(loads).toFixed(0)} ms, the median of ${LOADS} (${loads.map((each) => each.toFixed(0)).join(', ')})`);
const { page, close } = await open();
await page.waitForSelector('#connection.good');
await page.locator('#on').click();
const drawn_s = await cpuTime(page, () => page.waitForTimeout(15_000));
console.log(`the page with its lab, drawn without a GPU: ${(100 * drawn_s / 15).toFixed(0)} % of a core, of that the lab ${(100 * await share(page)).toFixed(1)} %`);
// Its own lab takes no time from here on.
await page.locator('#speed').selectOption('0');
/** The least of several. @type {[number[], number[]]} */
const [inBrowser, natively] = [[], []];
for (let turn = 0; turn < TURNS; turn++) {
  inBrowser.push(await cpuTime(page, () => headless(page)));
  natively.push(native());
}
const [browser_s, native_s] = [Math.min(...inBrowser), Math.min(...natively)];
console.log(`headless, every scenario with ${SEEDS} seeds: ${browser_s.toFixed(2)} s of the processor, natively ${native_s.toFixed(2)} s: ${(100 * native_s / browser_s).toFixed(0)} % of the native speed`);

const { elf, flash } = busy();
await serveAvr8js(page);
/** @type {[number[], number[]]} */
const [ours, theirs] = [[], []];
for (let turn = 0; turn < TURNS; turn++) {
  ours.push(await cpuTime(page, () => emulated(page, elf)));
  theirs.push(await cpuTime(page, async () => {
    const writes = await runAvr8js(page, flash, SCENARIO_S);
    if (Math.abs(writes - 1_000 * SCENARIO_S) > 2) throw new Error(`avr8js: ${writes} ticks in ${SCENARIO_S} s`);
  }));
}
await close();
const [our_factor, their_factor] = [ours, theirs].map((times) => SCENARIO_S / Math.min(...times));
console.log(`an image that waits in a loop, with the robot: ${our_factor?.toFixed(1)} times real time; on avr8js, without one: ${their_factor?.toFixed(2)}; ours over that: ${((our_factor ?? NaN) / (their_factor ?? NaN)).toFixed(1)}`);
