// @ts-check
/** The lab in a worker of this page, in place of a station: the same messages and orders as over the WebSocket. */

import { saveFile } from './dialog.js';

/** @typedef {import('./types.js').FromServer} FromServer */
/** @typedef {import('./types.js').Order} Order */
/** @typedef {import('./link.js').Connection} Connection */

/**
 * The run as a link carries it: `Shared` of `crates/browser`.
 * @typedef {object} Shared
 * @property {string | null} edited The file of the edited world in which it drives; `Share` packs it.
 * @property {string | null} file The file of a scenario that is not built in; `Share` packs it.
 * @property {number} robots Copies of the scenario's robot.
 * @property {Record<string, number>} parameters With which it began.
 * @property {string | null} drive The commands given by hand.
 * @property {string | null} why_not Why a link cannot repeat them.
 * @property {number} changes
 * @property {number} until_s
 * @property {string | null} hash
 */

/**
 * What the worker says of the port of a real robot: it is driven there, or no longer; it is back, or gone; why there is
 * none; how far the writing of a program is.
 * @typedef {{port: string | null} | {back: string | null} | {refused: string} | {flashed: import('./flash_form.js').Flashed}} PortNews
 */

/** The session runs in the page, not in a station: the site's `index.html` says so. */
export const isSite = document.querySelector('meta[name="rumbo-session"]')?.getAttribute('content') === 'page';

export class WorkerLink {
  /** @type {Worker | null} */
  #worker = null;
  #open = false;
  #onChange;
  /** Those who wait for the run. @type {((shared: Shared) => void)[]} */
  #waiting = [];
  /** Those who wait for causes. @type {((causes: string) => void)[]} */
  #asking = [];
  /** @type {(news: PortNews) => void} */
  onPort = () => {};

  /**
   * @param {(message: FromServer) => void} onMessage
   * @param {(now: Connection, why: string | null) => void} onChange called when the lab is there, and when it has ended
   */
  constructor(onMessage, onChange) {
    this.#onChange = onChange;
    if (typeof WebAssembly !== 'object' || typeof Worker !== 'function') {
      // After the constructor: the caller has no link yet.
      queueMicrotask(() => this.#end('this browser has no WebAssembly or no workers; open the page in another one'));
      return;
    }
    const worker = new Worker(new URL(`../lab/worker.js?${location.hash.slice(1)}`, import.meta.url), { type: 'module' });
    this.#worker = worker;
    worker.addEventListener('message', ({ data }) => {
      if (data.bytes) return saveFile(data.name, new Blob([data.bytes], { type: 'application/octet-stream' }));
      if (data.shared) return this.#waiting.shift()?.(JSON.parse(data.shared));
      if (data.explained) return this.#asking.shift()?.(data.explained);
      if (['port', 'back', 'refused', 'flashed'].some((name) => name in data)) return this.onPort(data);
      if (!Array.isArray(data)) return this.#end(data.error);
      if (!this.#open) onChange('open', null);
      this.#open = true;
      for (const text of data) onMessage(JSON.parse(text));
      return worker.postMessage(null);
    });
    // A robot at a port stops by itself when its page is closed; so it does at once.
    addEventListener('pagehide', () => worker.postMessage('leave'));
    worker.addEventListener('error', (event) => this.#end(event.message || 'its program could not be loaded'));
  }

  /** @param {string} why */
  #end(why) {
    this.#worker?.terminate();
    this.#worker = null;
    this.#open = false;
    this.#onChange('ended', why);
  }

  /**
   * Saves the recording of the run so far as a file; shows it as a replay; shows the lab again; leaves the real robot for
   * the lab; begins anew; goes over to another robot in the world; drives a real robot; looks for it at another port;
   * writes a program to a board.
   * @param {'save' | 'replay' | 'resume' | 'leave' | {open: import('./run_link.js').Start} | {robot: number} | {connect: import('./robot_port.js').Wanted} | {choose: string} | {flash: import('./flash_form.js').Program}} what
   */
  ask(what) {
    this.#worker?.postMessage(what);
  }

  /** The run so far, for a link. @returns {Promise<Shared>} */
  share() {
    return new Promise((done) => {
      this.#waiting.push(done);
      this.#worker?.postMessage('share');
    });
  }

  /** What explains a stretch [s], as JSON. @param {number} from_s @param {number} to_s @returns {Promise<string>} */
  explain(from_s, to_s) {
    return new Promise((done) => {
      this.#asking.push(done);
      this.#worker?.postMessage({ explain: [from_s, to_s] });
    });
  }

  /** Shows a recording in place of the lab. @param {File} file */
  async show(file) {
    const bytes = new Uint8Array(await file.arrayBuffer());
    this.#worker?.postMessage({ name: file.name, bytes }, [bytes.buffer]);
  }

  /**
   * Gives an order to the lab; false if it is not there (yet).
   * @param {Order} order
   */
  send(order) {
    if (!this.#worker || !this.#open) return false;
    this.#worker.postMessage(JSON.stringify(order));
    return true;
  }
}
