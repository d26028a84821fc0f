// @ts-check
/** The WebSocket to the server. It comes back by itself, and then gets the recent past anew. */

/** @typedef {import('./types.js').FromServer} FromServer */
/** @typedef {import('./types.js').Order} Order */

/** `locked`: the station was started again, and this browser has no key to it yet. @typedef {'open' | 'closed' | 'locked'} Connection */

const RETRY_MS = 500;
const RETRY_MAX_MS = 2_000;
/** An answer that takes longer is none [ms]. */
const ANSWER_MS = 1_000;

/** Whether a station is there, and this page has no key to it. */
async function turnedAway() {
  try {
    return (await fetch('/icon.svg?key', { cache: 'no-store', signal: AbortSignal.timeout(ANSWER_MS) })).status === 403;
  } catch {
    return false;
  }
}

export class Link {
  /** @type {WebSocket | null} */
  #socket = null;
  #retryMs = RETRY_MS;
  /** @type {string | null} */
  #lastError = null;
  /** @type {Connection} */
  #was = 'closed';
  #onMessage;
  #onChange;

  /**
   * @param {(message: FromServer) => void} onMessage
   * @param {(now: Connection, why: string | null) => void} onChange told when the connection opens or closes, and why the station closed it
   */
  constructor(onMessage, onChange) {
    this.#onMessage = onMessage;
    this.#onChange = onChange;
    this.#open();
  }

  #open() {
    const socket = new WebSocket(`ws://${location.host}/ws`);
    this.#socket = socket;
    socket.addEventListener('open', () => {
      this.#retryMs = RETRY_MS;
      this.#lastError = null;
      this.#change('open');
    });
    socket.addEventListener('message', (event) => {
      /** @type {FromServer} */
      const message = JSON.parse(event.data);
      if (message.type === 'error') this.#lastError = message.text;
      else this.#onMessage(message);
    });
    socket.addEventListener('close', async () => {
      this.#socket = null;
      if (this.#was === 'open') this.#change('closed');
      setTimeout(() => this.#open(), this.#retryMs);
      this.#retryMs = Math.min(2 * this.#retryMs, RETRY_MAX_MS);
      const now = await turnedAway() ? 'locked' : 'closed';
      if (this.#was !== 'open') this.#change(now);
    });
  }

  /** @param {Connection} now */
  #change(now) {
    this.#was = now;
    this.#onChange(now, this.#lastError);
  }

  /**
   * Sends an order; false if there is no connection. Orders are never kept for later: an old one is worse than none.
   * @param {Order} order
   */
  send(order) {
    if (this.#socket?.readyState !== WebSocket.OPEN) return false;
    this.#socket.send(JSON.stringify(order));
    return true;
  }
}
