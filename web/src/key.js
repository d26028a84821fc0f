// @ts-check
/**
 * The page's key to the station: exchanged for the token in the printed address, and kept in the browser's
 * storage for this address and port. (A cookie would go to every other port of the computer as well.)
 */
import { keep, recall } from './stored.js';

/** Time-out of an answer [ms]. */
const ANSWER_MS = 5_000;

/** The token in the address, until the station has answered. */
let token = location.search;
/** The station rejected it. */
let refused = false;
/** For a browser that stores nothing: until the page is left. @type {string | null} */
let own = null;

/** @param {string} key */
function store(key) {
  own = key;
  keep('key', key);
  return key;
}

/** The key, or something random: with it a page that missed the answer may show the token again. */
function shown() {
  own = recall('key') ?? own;
  return own ?? store(Array.from(crypto.getRandomValues(new Uint8Array(32)), (byte) => byte.toString(16).padStart(2, '0')).join(''));
}

/**
 * The key; or why there is none: no answer, no key to this station, or an expired address.
 * @returns {Promise<{key: string} | {key: null, why: 'closed' | 'locked' | 'used'}>}
 */
export async function askForKey() {
  try {
    const headers = { Authorization: `Bearer ${shown()}` };
    const answer = await fetch(`/key${token}`, { method: 'POST', headers, signal: AbortSignal.timeout(ANSWER_MS) });
    const key = await answer.text();
    if (token !== '') {
      refused = !answer.ok;
      token = '';
      history.replaceState(null, '', location.pathname + location.hash);
    }
    return answer.ok ? { key: store(key) } : { key: null, why: refused ? 'used' : 'locked' };
  } catch {
    return { key: null, why: 'closed' };
  }
}

/**
 * The answer of the station to a request with the page's key.
 * @param {string} path
 * @param {'GET' | 'POST' | 'DELETE'} [method]
 * @param {string} [body]
 * @returns {Promise<string>}
 */
export async function ask(path, method = 'GET', body) {
  const answer = await fetch(path, { method, body, headers: { Authorization: `Bearer ${shown()}` } });
  const text = await answer.text();
  if (!answer.ok) throw new Error(text);
  return text;
}
