// @ts-check
/** The WebSocket to the server. It comes back by itself, and then gets the recent past anew. */

/** @typedef {import('./types.js').FromServer} FromServer */
/** @typedef {import('./types.js').Order} Order */

const RETRY_MS = 500;
const RETRY_MAX_MS = 5_000;

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
   * @param {(open: boolean, why: string | null) => void} onChange told when the connection opens or closes
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
      this.#onChange(true, null);
    });
    socket.addEventListener('message', (event) => {
      /** @type {FromServer} */
      const message = JSON.parse(event.data);
      if (message.type === 'error') this.#lastError = message.text;
      else this.#onMessage(message);
    });
    socket.addEventListener('close', () => {
      this.#socket = null;
      this.#onChange(false, this.#lastError);
      setTimeout(() => this.#open(), this.#retryMs);
      this.#retryMs = Math.min(2 * this.#retryMs, RETRY_MAX_MS);
    });
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
