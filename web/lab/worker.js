// @ts-check
/**
 * The lab in a worker of the page: the simulator and its session as WebAssembly, in place of a station.
 *
 * Strings from the page are orders; null says that it has read what it was sent, and may be sent more: a slow page loses
 * samples of plots, and the lab does not wait for it. 'save' asks for the recording, a file `{ name, bytes }`; such a file
 * from the page is shown as a replay, as 'replay' shows the recording, and 'resume' shows the lab again. 'share' asks for the
 * run as a link carries it, `{ shared }`. To the page go arrays of the messages of the station's WebSocket, or `{ error }`
 * when the lab has ended.
 */
import { readLink } from '../src/run_link.js';
import init, { Lab, Recording } from './rumbo.js';

/** Time between two rounds [ms]; a round takes at most 20 ms, so that orders do not wait. */
const EVERY_MS = 10;
const STOP = JSON.stringify({ type: 'stop' });

/** @type {Lab | null} */
let lab = null;
let pageIsReady = true;

/** Advances the lab by the time that has passed. */
function round() {
  if (!lab) return;
  try {
    lab.advance();
    if (!pageIsReady) return;
    const news = lab.news();
    if (news.length === 0) return;
    pageIsReady = false;
    self.postMessage(news);
  } catch (error) {
    end(error);
  }
}

/** The recording of the run so far, as a file. @param {Lab} lab */
function recorded(lab) {
  return lab.log(new Date(lab.began_ms).toISOString().replace(/\.\d+/, ''));
}

/** @param {Lab} lab */
function save(lab) {
  try {
    const { name, bytes } = recorded(lab);
    self.postMessage({ name, bytes }, { transfer: [bytes.buffer] });
  } catch (error) {
    lab.warn(`not recording: ${error}`);
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

/** @param {unknown} error */
function end(error) {
  lab = null;
  self.postMessage({ error: error instanceof Error ? error.message : String(error) });
  self.close();
}

self.addEventListener('message', ({ data }) => {
  if (data === null) pageIsReady = true;
  if (!lab || data === null) return;
  if (data === 'save') save(lab);
  else if (data === 'replay') show(lab, recorded(lab));
  else if (data === 'resume') lab.resume();
  else if (data === 'share') self.postMessage({ shared: lab.share() });
  else if (typeof data === 'object') show(lab, data);
  else lab.order(data);
  // It does not wait for the next round.
  if (data === STOP) round();
});

/** The lab that the worker's address asks for; if it asks for what is not there, the usual one, which says so. */
function open() {
  const { start, version } = readLink(location.search);
  try {
    const made = new Lab(JSON.stringify(start));
    if (version !== null && version !== made.version) made.warn(`the link is of version ${version}, this is ${made.version}: the run may differ`);
    return made;
  } catch (error) {
    const made = new Lab('{}');
    made.warn(`the link is not for this version: ${error}`);
    return made;
  }
}

try {
  await init();
  lab = open();
  setInterval(round, EVERY_MS);
} catch (error) {
  end(error);
}
