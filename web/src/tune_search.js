// @ts-check
/** A search of *Tune* at the station, over its own WebSocket: it ends with that, and so with the page. */
import { askForKey } from './key.js';

/** As `rumbo tune` takes them. @typedef {{scenario: string, over: string[], params: Record<string, number>, aims: string, runs: number, seed: number}} Wanted */
/**
 * A metric with the values before and after, on the unseen robots; null: it has none.
 * @typedef {object} Difference
 * @property {string} metric
 * @property {[number, number]} never Runs in which it never happened.
 * @property {[number | null, number | null]} medians
 * @property {number | null} mean Of second minus first.
 * @property {[number | null, number | null]} interval That of 95 %.
 * @property {number | null} effect The mean over the standard deviation of the differences.
 * @property {number} better Share of the pairs in which the second is better.
 * @property {number} worse
 */
/**
 * What `rumbo tune --json` says, and the robot file with the values; null: more of the unseen robots fail than before.
 * @typedef {object} Found
 * @property {string} scenario
 * @property {number} runs
 * @property {{name: string, now: number, tuned: number}[]} parameters
 * @property {{seeds: number[], passed_now: number, passed_tuned: number}} held_out
 * @property {Difference[]} differences
 * @property {string | null} robot_file
 */
/** The experiment with seeds from `seed` on, `seeds` of them. @typedef {{scenario: string, world: string | null, rig: string | null, seed: number, seeds: number, params: Record<string, number>}} Seeds */
/** The report, in a language. @typedef {{report: string}} Report */
/** @typedef {{share: (share: number) => void, found: (found: any) => void, failed: (why: string) => void}} Listener */

const LOST = 'the connection to the station was lost, and the search with it';

export class Search {
  /** @type {WebSocket | null} */
  #socket = null;
  #over = false;

  /** @param {number} page the number of this page, which has to be in control @param {Wanted | Seeds | Report} wanted @param {Listener} listener */
  constructor(page, wanted, listener) {
    this.#open(page, wanted, listener);
  }

  /** @param {number} page @param {Wanted | Seeds | Report} wanted @param {Listener} listener */
  async #open(page, wanted, listener) {
    const { key } = await askForKey();
    if (this.#over) return;
    if (key === null) return listener.failed(LOST);
    const robot = /^#(robot=.*)/.exec(location.hash)?.[1];
    const socket = new WebSocket(`ws://${location.host}/tune/search?page=${page}${robot ? `&${robot}` : ''}`, ['rumbo', key]);
    this.#socket = socket;
    socket.addEventListener('open', () => socket.send(JSON.stringify(wanted)));
    socket.addEventListener('message', ({ data }) => {
      const news = JSON.parse(data);
      if (this.#over) return;
      if ('share' in news) listener.share(news.share);
      else if ('found' in news) listener.found(news.found);
      else listener.failed(news.error);
    });
    socket.addEventListener('close', () => {
      if (!this.#over) listener.failed(LOST);
    });
  }

  end() {
    this.#over = true;
    this.#socket?.close();
  }
}
