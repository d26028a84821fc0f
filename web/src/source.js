// @ts-check
/** What code pane and debugger do without a page: places in source, files that differ, requests and their responses. */

/** @typedef {import('./types.js').SketchFile} SketchFile */
/** @typedef {import('./types.js').DebugMessage} DebugMessage */

/** File, line and column of a compiler's `wall.ino:3:7`. @param {string | null} place */
export function placeOf(place) {
  const [, file = '', line = '', column] = place?.match(/^(.+?):(\d+)(?::(\d+))?$/) ?? [];
  return file === '' ? null : { file, line: Number(line), column: column ? Number(column) : null };
}

/** A sketch's name as the lab takes it. @param {string} name */
export const plainName = (name) => name.replace(/^example:|\.ino$/g, '').replace(/^\.|[^A-Za-z0-9_. -]/g, '_');

/** The same files with the same texts. @param {SketchFile[]} one @param {SketchFile[]} other */
export function sameFiles(one, other) {
  const sorted = (/** @type {SketchFile[]} */ files) => JSON.stringify(files.map(({ name, text }) => [name, text]).sort());
  return sorted(one) === sorted(other);
}

/** Requests and their responses, by number. */
export class Requests {
  #send;
  /** @type {Map<number, {done: (body: any) => void, failed: (error: Error) => void}>} */
  #waiting = new Map();
  // Responses go to every page, those to other pages too.
  #next = Math.floor(Math.random() * 1e9);

  /** @param {(request: object) => void} send */
  constructor(send) {
    this.#send = send;
  }

  /** @param {string} command @param {object} [args] @returns {Promise<any>} the response's body */
  ask(command, args = {}) {
    const seq = this.#next++;
    const answer = new Promise((done, failed) => this.#waiting.set(seq, { done, failed }));
    this.#send({ seq, type: 'request', command, arguments: args });
    return answer;
  }

  /** @param {DebugMessage} message */
  receive(message) {
    const waiting = this.#waiting.get(message.request_seq ?? -1);
    if (!waiting) return;
    this.#waiting.delete(message.request_seq ?? -1);
    if (message.success) waiting.done(message.body ?? {});
    else waiting.failed(new Error(message.message ?? ''));
  }

  /** Nothing will be answered any more. */
  forget() {
    this.#waiting.clear();
  }
}
