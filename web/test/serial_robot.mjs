// @ts-check
/**
 * A serial port for the site's tests: `navigator.serial` of the page and of its worker is a stand-in, whose other end is
 * the simulated robot of `rumbo lab --pty`, behind the server of the site.
 */
import { spawn } from 'node:child_process';
import { openSync, writeSync } from 'node:fs';
import { createInterface } from 'node:readline';
import { ReadStream } from 'node:tty';
import { program } from './dashboard.mjs';

/** Below the site's address. */
const BELOW = 'fake/';
const INFO = { usbVendorId: 0x2341, usbProductId: 0x42 };

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
  /** The same objects each time, as browsers give them. @type {Port[]} */
  let ports = [];
  const serial = {
    async getPorts() {
      const infos = await (await ask('ports')).json();
      ports = infos.map((/** @type {any} */ info, /** @type {number} */ index) => ports[index] ?? new Port(info));
      return ports;
    },
    async requestPort() {
      if (!(await ask('grant', { method: 'POST' })).ok) throw new DOMException('No port selected by the user.', 'NotFoundError');
      return (await serial.getPorts()).at(-1);
    },
  };
  Object.defineProperty(navigator, 'serial', { value: serial, configurable: true });
}

/** The other end of the port, with the test's hand on its plug. */
export class SerialRobot {
  /** A person chooses a port when asked. */
  chooses = true;
  /** Bytes sent to the robot so far. */
  sent = 0;
  #plugged = true;
  #granted = 0;
  /** @type {Set<import('node:http').ServerResponse>} */
  #readers = new Set();
  /** @type {number | null} */
  #pty = null;

  /** @param {import('node:child_process').ChildProcess} robot @param {string} path of its pseudo terminal */
  constructor(robot, path) {
    this.robot = robot;
    this.#pty = openSync(path, 'r+');
    this.terminal = new ReadStream(this.#pty);
    this.terminal.setRawMode(true);
    this.terminal.on('data', (bytes) => this.#readers.forEach((reader) => reader.write(bytes)));
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
      if (this.chooses) this.#granted = 1;
      response.writeHead(this.chooses ? 204 : 403).end();
    } else if (what === 'ports') {
      response.writeHead(200, { 'Content-Type': 'application/json' }).end(JSON.stringify(this.#plugged ? Array(this.#granted).fill(INFO) : []));
    } else if (what === 'open' && this.#plugged) {
      response.writeHead(200, { 'Content-Type': 'application/octet-stream' });
      response.flushHeaders();
      this.#readers.add(response);
      response.on('close', () => this.#readers.delete(response));
    } else if (what === 'write' && this.#plugged) {
      request.on('data', (/** @type {Buffer} */ bytes) => {
        this.sent += bytes.length;
        if (this.#pty !== null) writeSync(this.#pty, bytes);
      });
      request.on('end', () => response.writeHead(204).end());
    } else if (what === 'close') {
      this.#readers.forEach((reader) => reader.end());
      response.writeHead(204).end();
    } else {
      response.writeHead(503).end();
    }
    return true;
  }

  close() {
    this.terminal.destroy();
    this.robot.kill();
  }
}

/** Starts a simulated robot at a port. */
export async function startRobot() {
  const robot = spawn(program(), ['lab', '--pty'], { stdio: ['ignore', 'pipe', 'inherit'] });
  for await (const path of createInterface({ input: robot.stdout })) return new SerialRobot(robot, path.trim());
  throw new Error('rumbo lab --pty: no port');
}
