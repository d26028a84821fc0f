// @ts-check
/**
 * The session in a worker of the page, as WebAssembly, in place of a station: with the simulated robot of the lab, or with a
 * real one at a serial port. While there is a real one the lab waits: the heartbeat shares the worker with no simulation.
 *
 * Strings from the page are orders; null says that it has read what it was sent, and may be sent more: a slow page loses
 * samples of plots, and the session does not wait for it. 'save' asks for the recording, a file `{ name, bytes }`; such a
 * file from the page is shown as a replay, as 'replay' shows the recording, and 'resume' shows the lab again. 'share' asks
 * for the run as a link carries it, `{ shared }`; `{ explain }`, from and to in s, for what explains that time, `{ explained }`. `{ open }` begins anew with what it gives, and with the rest as it is;
 * `{ robot }` makes the page that of another robot in the world. `{ connect }` begins a session with the robot at a port, `{ choose }`
 * looks for it at another one, and 'leave' goes back to the lab; `{ port }` is the port's name or null, `{ back }` the
 * name when it is there again or null when it is gone, `{ refused }` why there is none. `{ flash }` writes a program to a board, `{ flashed }` says how far that is. To the page go arrays of the messages of the station's WebSocket, or `{ error }` when the session has ended.
 */
import { readLink, unpack, wrongNumber } from '../src/run_link.js';
import { LOCK } from '../src/serial_ports.js';
import { flash } from './flash.js';
import init, { Flasher, Lab, Recording, Robot } from './rumbo.js';
import { SerialLink, pause, wordsOf } from './serial_link.js';

/** What the page asks for to drive a real robot. @typedef {{kind: string, name: string, baud: number, text: boolean}} Wanted */

/** A program to be written, and the port of the board. @typedef {{kind: string, name: string, file: string, content: Uint8Array}} Program */
/** How far that is: a phase and the part that is done, or why it has ended. @typedef {{phase: string, part: number} | {error: string}} Flashed */
/** @typedef {{session: Robot, link: SerialLink, release: () => void, leaving: boolean}} Driven */

/** Time between two rounds [ms]; a round takes at most 20 ms, so that orders do not wait. */
const EVERY_MS = 10;
const STOP = JSON.stringify({ type: 'stop' });
/** A robot that is left has this long to acknowledge STOP [ms]; without heartbeats it stops by itself after 500. */
const LEAVING_MS = 300;

/** @type {Lab | null} */
let lab = null;
/** A real robot, which is driven in place of the lab. @type {Driven | null} */
let real = null;
let pageIsReady = true;

/** Advances the session by the time that has passed. */
function round() {
  const session = real?.session ?? lab;
  if (!session) return;
  try {
    session.advance();
    if (real) advanceRobot(real.session, real.link);
    if (!pageIsReady) return;
    const news = session.news();
    if (news.length === 0) return;
    pageIsReady = false;
    self.postMessage(news);
  } catch (error) {
    end(error);
  }
}

/** @param {Robot} robot @param {SerialLink} link */
function advanceRobot(robot, link) {
  link.send(robot.take_outgoing());
  const file = robot.saved();
  if (file) give(file);
}

/** @param {{name: string, bytes: Uint8Array<ArrayBuffer>}} file */
function give({ name, bytes }) {
  self.postMessage({ name, bytes }, { transfer: [bytes.buffer] });
}

/** When a session began, as its recording has it. @param {Lab | Robot} session */
const started = (session) => new Date(session.began_ms).toISOString().replace(/\.\d+/, '');

/** The recording of the run so far, as a file. @param {Lab} lab */
const recorded = (lab) => lab.log(started(lab));

/** Does it, or warns the page why not. @param {Lab | Robot} session @param {() => void} work */
function orWarn(session, work) {
  try {
    work();
  } catch (error) {
    session.warn(`not recording: ${error}`);
  }
}

/** Shows a recording in place of the lab. @param {Lab} lab @param {{ name: string, bytes: Uint8Array }} file */
function show(lab, { name, bytes }) {
  try {
    lab.show(new Recording(name, bytes));
  } catch (error) {
    lab.warn(error instanceof WebAssembly.RuntimeError ? `${name}: not opened, it does not fit into the memory of the page; \`rumbo replay\` shows it on a computer` : String(error));
  }
}

/** Takes the lock of those who drive a robot; gives what releases it, or null: another page has it. @returns {Promise<(() => void) | null>} */
function takeLock() {
  return new Promise((done, failed) => {
    navigator.locks.request(LOCK, { ifAvailable: true }, (lock) => {
      if (!lock) return done(null);
      return new Promise((release) => done(() => release(null)));
    }).catch(failed);
  });
}

/** Begins a session with a real robot; the lab waits. @param {Wanted} wanted */
async function connect({ kind, name, baud, text }) {
  if (real) return;
  const release = await takeLock();
  if (!release) {
    self.postMessage({ refused: 'another page of this browser drives a robot: go back to its lab first' });
    return;
  }
  const link = new SerialLink(kind, baud, (bytes) => real?.session.arrived(bytes), (now) => {
    if ('back' in now) real?.session.back(now.back);
    else real?.session.lost(now.lost);
    self.postMessage({ back: 'back' in now ? now.back : null });
  });
  try {
    await link.open();
    real = { session: new Robot(name, baud, text), link, release, leaving: false };
    self.postMessage({ port: name });
    round();
  } catch (error) {
    release();
    await link.close();
    self.postMessage({ refused: `port ${name} cannot be opened (${wordsOf(error)}): is it in use by another program, is the robot switched on?` });
  }
}

/** @param {Flashed} flashed */
const report = (flashed) => self.postMessage({ flashed });

/** Writes a program to the board at a port. @param {Program} program */
async function write({ kind, name, file, content }) {
  const release = await takeLock();
  if (!release) return report({ error: 'another page of this browser drives a robot: go back to its lab first' });
  /** @type {Flasher | null} */
  let flasher = null;
  try {
    const made = new Flasher(file, content);
    flasher = made;
    let reported = -1;
    await flash(kind, made, () => {
      const percent = Math.floor(made.part * 100);
      if (percent !== reported) report({ phase: made.phase, part: made.part });
      reported = percent;
    });
    report({ phase: 'done', part: 1 });
  } catch (error) {
    report({ error: `${name}: ${wordsOf(error)}${flasher?.aftermath ?? ''}` });
  }
  flasher?.free();
  return release();
}

/** Stops the robot and goes back to the lab; the page gets the recording. @param {Driven} robot */
async function leave(robot) {
  const { session, link, release } = robot;
  robot.leaving = true;
  session.order(STOP);
  round();
  await pause(LEAVING_MS);
  real = null;
  // A port that is gone may take its time.
  link.close().finally(release);
  try {
    session.save(started(session));
    let file = session.saved();
    while (!file) file = session.saved();
    give(file);
  } catch (error) {
    lab?.warn(`not recording: ${error}`);
  }
  session.free();
  lab?.resume();
  self.postMessage({ port: null });
}

/** What the page asks of a session with a real robot. @param {Driven} robot @param {any} data */
function askRobot(robot, data) {
  const { session, link, leaving } = robot;
  if (data === 'leave') {
    if (!leaving) leave(robot).catch(end);
  } else if (data === 'save') orWarn(session, () => session.save(started(session)));
  else if (data === STOP || (!leaving && typeof data === 'string' && data.startsWith('{'))) session.order(data);
  else if (leaving) return;
  else if (data.choose) link.choose(data.choose);
  // To read a recording takes seconds, and the heartbeat would wait for it.
  else session.warn('not while a real robot is driven: go back to the lab first');
}

/**
 * Restarts with `changes`; a given scenario comes with its own world and robots.
 * @param {Lab} before @param {import('../src/run_link.js').Start} changes
 */
function begin(before, changes) {
  const { file, edited, parameters } = JSON.parse(before.share());
  try {
    lab = new Lab(JSON.stringify(changes.file ? { parameters, ...changes } : { file, edited, parameters, ...changes }));
    before.free();
  } catch (error) {
    before.warn(String(error));
  }
}

/** What the page asks of the lab. @param {Lab} lab @param {any} data */
function askLab(lab, data) {
  if (data === 'save') orWarn(lab, () => give(recorded(lab)));
  else if (data === 'replay') show(lab, recorded(lab));
  else if (data === 'resume') lab.resume();
  else if (data === 'share') self.postMessage({ shared: lab.share() });
  else if (data.explain) self.postMessage({ explained: lab.explain(data.explain[0], data.explain[1]) });
  else if (data.open) begin(lab, data.open);
  else if ('robot' in Object(data)) lab.select(data.robot);
  else if (data.connect) connect(data.connect).catch(end);
  else if (data.flash) write(data.flash).catch(end);
  else if (data.bytes) show(lab, data);
  else if (typeof data === 'string' && data.startsWith('{')) lab.order(data);
}

/** @param {unknown} error */
function end(error) {
  lab = real = null;
  self.postMessage({ error: wordsOf(error) });
  self.close();
}

self.addEventListener('message', ({ data }) => {
  if (data === null) pageIsReady = true;
  if (!lab || data === null) return;
  if (real) askRobot(real, data);
  else askLab(lab, data);
  // It does not wait for the next round.
  if (data === STOP) round();
});

/** The lab that the worker's address asks for; if it asks for what is not there, the usual one, which says so. */
async function open() {
  const { start, version } = readLink(location.search);
  try {
    const wrong = wrongNumber(start);
    if (wrong !== null) throw new Error(wrong);
    if (start.edited) start.edited = await unpack(start.edited);
    if (start.file) start.file = await unpack(start.file);
    const made = new Lab(JSON.stringify(start));
    if (version !== null && version !== made.version) made.warn(`the link is of version ${version}, this is ${made.version}: the run may differ`);
    return made;
  } catch (error) {
    const made = new Lab('{}');
    made.warn(`the link is not for this version: ${error instanceof Error ? error.message : error}`);
    return made;
  }
}

try {
  await init();
  lab = await open();
  setInterval(round, EVERY_MS);
} catch (error) {
  end(error);
}
