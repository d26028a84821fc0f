// @ts-check
/**
 * The page's key to the station: given for the token in the address that the station printed, and kept in the browser's
 * storage for this address and port. (A cookie would go to every other port of the computer as well.)
 */

const STORED = 'rumbo.key';
/** An answer that takes longer is none [ms]. */
const ANSWER_MS = 1_000;

/** The token in the address, until the station has answered. */
let token = location.search;
/** The station did not take it. */
let refused = false;
/** For a browser that stores nothing: until the page is left. @type {string | null} */
let own = null;

function stored() {
  try {
    return localStorage.getItem(STORED) ?? own;
  } catch {
    return own;
  }
}

/** @param {string} key */
function store(key) {
  own = key;
  try {
    localStorage.setItem(STORED, key);
  } catch {
    // The page has it.
  }
}

/**
 * The key; or why there is none: no answer, no key to this station, or an address that opens no more.
 * @returns {Promise<{key: string} | {key: null, why: 'closed' | 'locked' | 'used'}>}
 */
export async function askForKey() {
  const had = stored();
  try {
    const answer = await fetch(`/key${token}`, {
      method: 'POST',
      headers: had === null ? {} : { Authorization: `Bearer ${had}` },
      signal: AbortSignal.timeout(ANSWER_MS),
    });
    const key = await answer.text();
    if (token !== '') {
      refused = !answer.ok;
      token = '';
      history.replaceState(null, '', location.pathname);
    }
    if (!answer.ok) return { key: null, why: refused ? 'used' : 'locked' };
    if (key !== had) store(key);
    return { key };
  } catch {
    return { key: null, why: 'closed' };
  }
}
