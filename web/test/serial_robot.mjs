// @ts-check
/**
 * A serial port for the site's tests: `navigator.serial` of the page and of its worker is a stand-in, whose other end is
 * behind the server of the site: the simulated robot of `rumbo lab --pty`, or a boot loader.
 */
import { spawn } from 'node:child_process';
import { openSync, writeSync } from 'node:fs';
import { createInterface } from 'node:readline';
import { ReadStream } from 'node:tty';
import { program } from './dashboard.mjs';

/** Below the site's address. */
const BELOW = 'fake/';

/** The stand-in for `navigator.serial`, run in page and worker. @param {string} base the address of the stand-in's server */
function standIn(base) {
  const lost = () => new DOMException('The device has been lost.', 'NetworkError');
  /** @param {string} what @param {RequestInit} [options] */
  const ask = (what, options) => fetch(base + what, options);
  class Port {
    /** @type {ReadableStream | null} */
    readable = null;
    /** @type {WritableStream | null} */
    writable = null;
    /** @param {any} info */
    constructor(info) {
      this.getInfo = () => info;
    }

    /** @param {{baudRate: number}} options */
    async open({ baudRate }) {
      if (this.readable) throw new DOMException('The port is already open.', 'InvalidStateError');
      const answer = await ask(`open?baud=${baudRate}`);
      const reader = answer.body?.getReader();
      if (!answer.ok || !reader) throw new DOMException('Failed to open serial port.', 'NetworkError');
      this.readable = new ReadableStream({
        pull: async (into) => {
          const { done, value } = await reader.read().catch(() => ({ done: true, value: undefined }));
          if (!done) return into.enqueue(value);
          this.readable = null;
          return into.error(lost());
        },
        cancel: () => reader.cancel(),
      });
      this.writable = new WritableStream({
        async write(bytes) {
          const answer = await ask('write', { method: 'POST', body: bytes });
          if (!answer.ok) throw lost();
        },
      });
    }

    async close() {
      this.readable = this.writable = null;
      await ask('close', { method: 'POST' });
    }

    async forget() {
      await ask('forget', { method: 'POST' });
    }

    /** @param {any} signals */
    async setSignals(signals) {
      await ask('signals', { method: 'POST', body: JSON.stringify(signals) });
    }
  }
  /** The same objects each time, as browsers give them. @type {Map<string, Port>} */
  const ports = new Map();
  const serial = {
    async getPorts() {
      const infos = await (await ask('ports')).json();
      return infos.map((/** @type {any} */ info) => {
        const port = ports.get(JSON.stringify(info)) ?? new Port(info);
        ports.set(JSON.stringify(info), port);
        return port;
      });
    },
    async requestPort() {
      if (!(await ask('grant', { method: 'POST' })).ok) throw new DOMException('No port selected by the user.', 'NotFoundError');
      return (await serial.getPorts()).at(-1);
    },
  };
  Object.defineProperty(navigator, 'serial', { value: serial, configurable: true });
}

/**
 * What is at the other end of the port.
 * @typedef {object} End
 * @property {(bytes: Buffer) => void} write
 * @property {(send: (bytes: Uint8Array) => void) => void} begin
 * @property {(signals: {dataTerminalReady?: boolean}) => void} signal
 * @property {() => void} close
 */

/** The port, with the test's hand on its plug. */
export class SerialRobot {
  /** A person chooses a port when asked. */
  chooses = true;
  /** Bytes sent to the robot so far. */
  sent = 0;
  /** The last speed at which it was opened [baud]. @type {number | null} */
  baud = null;
  /** What its port says of itself. */
  info = { usbVendorId: 0x2341, usbProductId: 0x42 };
  #plugged = true;
  /** Those that a person has chosen. @type {Set<string>} */
  #granted = new Set();
  /** @type {Set<import('node:http').ServerResponse>} */
  #readers = new Set();
  #end;

  /** @param {End} end */
  constructor(end) {
    this.#end = end;
    end.begin((bytes) => this.#readers.forEach((reader) => reader.write(bytes)));
  }

  /** What the page runs before its own scripts; and the worker. @param {string} url of the site */
  script(url) {
    return `(${standIn})(${JSON.stringify(url + BELOW)});\n`;
  }

  unplug() {
    this.#plugged = false;
    for (const reader of this.#readers) reader.destroy();
    this.#readers.clear();
  }

  plug() {
    this.#plugged = true;
  }

  /**
   * Answers the stand-in; false if the request is not its.
   * @param {string} path below the site @param {import('node:http').IncomingMessage} request @param {import('node:http').ServerResponse} response
   */
  answer(path, request, response) {
    if (!path.startsWith(BELOW)) return false;
    const what = path.slice(BELOW.length);
    if (what === 'grant') {
      if (this.chooses) this.#granted.add(JSON.stringify(this.info));
      response.writeHead(this.chooses ? 204 : 403).end();
    } else if (what === 'ports') {
      response.writeHead(200, { 'Content-Type': 'application/json' }).end(JSON.stringify(this.#plugged && this.#granted.has(JSON.stringify(this.info)) ? [this.info] : []));
    } else if (what === 'open' && this.#plugged) {
      this.baud = Number(new URL(request.url ?? '', 'http://localhost').searchParams.get('baud'));
      response.writeHead(200, { 'Content-Type': 'application/octet-stream' });
      response.flushHeaders();
      this.#readers.add(response);
      response.on('close', () => this.#readers.delete(response));
    } else if (what === 'write' && this.#plugged) {
      request.on('data', (/** @type {Buffer} */ bytes) => {
        this.sent += bytes.length;
        this.#end.write(bytes);
      });
      request.on('end', () => response.writeHead(204).end());
    } else if (what === 'signals') {
      request.on('data', (/** @type {Buffer} */ signals) => this.#end.signal(JSON.parse(signals.toString())));
      request.on('end', () => response.writeHead(204).end());
    } else if (what === 'close') {
      // Not with the answer's own close event: the robot writes on before it comes.
      this.#readers.forEach((reader) => reader.end());
      this.#readers.clear();
      response.writeHead(204).end();
    } else {
      response.writeHead(503).end();
    }
    return true;
  }

  close() {
    this.#end.close();
  }
}

/** Starts a simulated robot at a port. */
export async function startRobot() {
  const robot = spawn(program(), ['lab', '--pty'], { stdio: ['ignore', 'pipe', 'inherit'] });
  for await (const path of createInterface({ input: robot.stdout })) {
    const pty = openSync(path.trim(), 'r+');
    const terminal = new ReadStream(pty);
    terminal.setRawMode(true);
    return new SerialRobot({
      write: (bytes) => { writeSync(pty, bytes); },
      begin: (send) => terminal.on('data', send),
      signal: () => {},
      close: () => {
        terminal.destroy();
        robot.kill();
      },
    });
  }
  throw new Error('rumbo lab --pty: no port');
}

/** A board's flash and boot loader, as far as one sees them from the port; `crates/flash` is tested with the real one. */
export class BootLoader {
  flash = Buffer.alloc(0x3_E000, 0xFF);
  signature = [0x1E, 0x98, 0x01];
  /** How often DTR was pulled. */
  resets = 0;
  #address = 0;
  #erased = 0;
  #received = Buffer.alloc(0);
  /** @type {(bytes: Uint8Array) => void} */
  #send = () => {};

  /** @param {(bytes: Uint8Array) => void} send */
  begin(send) {
    this.#send = send;
  }

  /** @param {{dataTerminalReady?: boolean}} signals */
  signal({ dataTerminalReady }) {
    if (!dataTerminalReady) return;
    this.resets += 1;
    this.#address = this.#erased = 0;
    this.#received = Buffer.alloc(0);
  }

  /** @param {Buffer} bytes */
  write(bytes) {
    this.#received = Buffer.concat([this.#received, bytes]);
    for (;;) {
      const length = this.#received.length < 5 ? Infinity : this.#received.readUInt16BE(2);
      if (this.#received.length < length + 6) return;
      const answer = this.#obey(this.#received.subarray(5, 5 + length));
      const message = Buffer.from([0x1B, this.#received[1] ?? 0, answer.length >> 8, answer.length & 255, 0x0E, ...answer, 0]);
      message[message.length - 1] = message.reduce((sum, byte) => sum ^ byte, 0);
      this.#received = this.#received.subarray(length + 6);
      this.#send(message);
    }
  }

  /** @param {Buffer} body @returns {number[]} */
  #obey(body) {
    const [command] = body;
    const size = body.length > 2 ? body.readUInt16BE(1) : 0;
    if (command === 0x1B) return [0x1B, 0, this.signature[body[4] ?? 0] ?? 0, 0];
    if (command === 0x06) this.#address = 2 * body.readUInt32BE(1);
    if (command === 0x14) {
      const page = this.flash.subarray(this.#address, this.#address += size);
      return [0x14, 0, ...page, 0];
    }
    if (command === 0x13) {
      this.flash.fill(0xFF, this.#erased, this.#erased += size);
      for (const byte of body.subarray(10)) this.flash.writeUInt8(this.flash.readUInt8(this.#address) & byte, this.#address++);
    }
    return [command ?? 0, 0];
  }

  close() {}
}
