// @ts-check
/** The WebSocket to the server. It reconnects by itself, and then receives the recent past again. */
import { askForKey } from './key.js';

/** @typedef {import('./types.js').FromServer} FromServer */
/** @typedef {import('./types.js').Order} Order */

/**
 * `locked`: a station is there to which this browser has no key; `used`: the address of the page gave none; `ended`: the
 * lab of the page is gone.
 * @typedef {'open' | 'closed' | 'locked' | 'used' | 'ended'} Connection
 */

const RETRY_MS = 500;
const RETRY_MAX_MS = 2_000;

export class Link {
  /** @type {WebSocket | null} */
  #socket = null;
  #retryMs = RETRY_MS;
  /** @type {string | null} */
  #lastError = null;
  #onMessage;
  #onChange;

  /**
   * @param {(message: FromServer) => void} onMessage
   * @param {(now: Connection, why: string | null) => void} onChange called when the connection opens or closes, with the
*   station's reason for closing it
   */
  constructor(onMessage, onChange) {
    this.#onMessage = onMessage;
    this.#onChange = onChange;
    this.#open();
    // Another robot in the world, by the address: its session begins as a connection that comes back does.
    addEventListener('hashchange', () => this.#socket?.close());
  }

  async #open() {
    const answer = await askForKey();
    if (answer.key === null) return this.#again(answer.why);
    const socket = new WebSocket(`ws://${location.host}/ws${location.hash.replace(/^#(?=robot=)/, '?')}`, ['rumbo', answer.key]);
    this.#socket = socket;
    socket.addEventListener('open', () => {
      this.#retryMs = RETRY_MS;
      this.#lastError = null;
      this.#onChange('open', null);
    });
    socket.addEventListener('message', (event) => {
      /** @type {FromServer} */
      const message = JSON.parse(event.data);
      if (message.type === 'error') this.#lastError = message.text;
      else this.#onMessage(message);
    });
    const asked = location.hash;
    socket.addEventListener('close', () => {
      this.#socket = null;
      if (location.hash === asked) this.#again('closed');
      else this.#open();
    });
  }

  /** @param {Connection} now */
  #again(now) {
    this.#onChange(now, this.#lastError);
    setTimeout(() => this.#open(), this.#retryMs);
    this.#retryMs = Math.min(2 * this.#retryMs, RETRY_MAX_MS);
  }

  /**
   * Sends an order; false if there is no connection. Orders are never queued: a late one is worse than none.
   * @param {Order} order
   */
  send(order) {
    if (this.#socket?.readyState !== WebSocket.OPEN) return false;
    this.#socket.send(JSON.stringify(order));
    return true;
  }
}
