// @ts-check
/** What the browser keeps for the page: until it is deleted, or as long as the tab lives. It may be forbidden to the page, or full. */

/** @typedef {'localStorage' | 'sessionStorage'} Where */

/** Null: nothing is kept; undefined: nothing can be. @param {string} name @param {Where} [where] */
export function recall(name, where = 'localStorage') {
  try {
    return window[where].getItem(`rumbo.${name}`);
  } catch {
    return undefined;
  }
}

/** Whether it is kept. @param {string} name @param {string} text @param {Where} [where] */
export function keep(name, text, where = 'localStorage') {
  try {
    window[where].setItem(`rumbo.${name}`, text);
    return true;
  } catch {
    return false;
  }
}
