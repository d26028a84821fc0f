// @ts-check
/** A robot's port in the worker: moves its bytes, and opens it again when it was gone. */
import { kindOf, nameOf, serial } from '../src/serial_ports.js';

/** @typedef {import('../src/serial_ports.js').SerialPort} SerialPort */

/** Opening a port that is gone is tried this often [ms]. */
const AGAIN_MS = 250;
/** Room for what arrives while the worker is busy [bytes]: more than a page of flash. */
const BUFFER = 4_096;
/** A port that takes no bytes for this long loses those that come then: what needs an answer is sent again [ms]. */
const PATIENCE_MS = 100;

/**
 * The port of this kind that was granted to the page, opened.
 * @param {string} kind
 * @param {number} baudRate
 */
export async function openPort(kind, baudRate) {
  const alike = (await serial()?.getPorts() ?? []).filter((port) => kindOf(port) === kind);
  const [port] = alike;
  // With two, a robot might drive unobserved.
  if (!port || alike.length > 1) throw new Error(port ? 'there are two of the kind: choose one again' : 'the browser does not offer it: plug it in, or choose it again');
  await port.open({ baudRate, bufferSize: BUFFER });
  return port;
}

/** Waits. @param {number} ms */
export const pause = (ms) => new Promise((done) => setTimeout(done, ms));

/** @param {unknown} error */
export const wordsOf = (error) => (error instanceof Error ? error.message : String(error));

export class SerialLink {
  #kind;
  #baud;
  #arrived;
  #changed;
  /** @type {SerialPort | null} */
  #port = null;
  /** @type {ReadableStreamDefaultReader<Uint8Array> | null} */
  #reader = null;
  /** @type {WritableStreamDefaultWriter<Uint8Array> | null} */
  #writer = null;
  /** Since when bytes wait to be taken by the port [ms]. @type {number | null} */
  #busy_ms = null;
  /** Why it takes no more bytes. @type {string | null} */
  #broken = null;
  #ended = false;
  /** Reading, and opening again. @type {Promise<void>} */
  #work = Promise.resolve();

  /**
   * @param {string} kind of the port
   * @param {number} baud
   * @param {(bytes: Uint8Array) => void} arrived
   * @param {(now: {lost: string} | {back: string}) => void} changed called when the port is gone, with the reason, and when
   *   it is back, or another one, with its name
   */
  constructor(kind, baud, arrived, changed) {
    this.#kind = kind;
    this.#baud = baud;
    this.#arrived = arrived;
    this.#changed = changed;
  }

  async open() {
    this.#use(await openPort(this.#kind, this.#baud));
    this.#work = this.#keep();
  }

  /** Another port from now on: somebody chose it while this one is gone. @param {string} kind */
  choose(kind) {
    this.#kind = kind;
  }

  /** @param {SerialPort} port */
  #use(port) {
    this.#port = port;
    this.#busy_ms = this.#broken = null;
    this.#writer = port.writable?.getWriter() ?? null;
  }

  /** Reads, and opens the port again whenever it is gone. */
  async #keep() {
    while (!this.#ended) {
      const why = await this.#read();
      await this.#closePort();
      if (!this.#ended) this.#changed({ lost: why });
      await this.#reopen();
    }
    await this.#closePort();
  }

  /** Reads until the port is gone. @returns {Promise<string>} why */
  async #read() {
    let why = 'it gives no bytes';
    // After damaged bytes the port gives another stream.
    for (let stream = this.#port?.readable; stream && !this.#ended && this.#broken === null; stream = this.#port?.readable) {
      const reader = stream.getReader();
      this.#reader = reader;
      try {
        for (let next = await reader.read(); !next.done; next = await reader.read()) this.#arrived(next.value);
      } catch (error) {
        why = wordsOf(error);
      }
      reader.releaseLock();
      await pause(1);
    }
    this.#reader = null;
    return this.#broken ?? why;
  }

  async #reopen() {
    while (!this.#ended) {
      await pause(AGAIN_MS);
      const port = await openPort(this.#kind, this.#baud).catch(() => null);
      if (!port) continue;
      this.#use(port);
      if (!this.#ended) this.#changed({ back: nameOf(port) });
      return;
    }
  }

  /** Sends bytes, or drops them: while the port is gone, or takes none. @param {Uint8Array} bytes */
  send(bytes) {
    const writer = this.#writer;
    if (!writer || bytes.length === 0) return;
    if (this.#busy_ms !== null && performance.now() - this.#busy_ms > PATIENCE_MS) return;
    this.#busy_ms ??= performance.now();
    writer.write(bytes).then(() => { this.#busy_ms = null; }, (error) => {
      if (writer !== this.#writer) return;
      this.#broken = wordsOf(error);
      this.#reader?.cancel().catch(() => {});
    });
  }

  async #closePort() {
    const [port, writer] = [this.#port, this.#writer];
    this.#port = this.#writer = null;
    // Queued bytes are not sent to a robot without a session; a port that is gone is closed already.
    await writer?.abort().catch(() => {});
    writer?.releaseLock();
    await port?.close().catch(() => {});
  }

  /** Closes it for good. */
  async close() {
    this.#ended = true;
    await this.#reader?.cancel().catch(() => {});
    await this.#work;
  }
}
