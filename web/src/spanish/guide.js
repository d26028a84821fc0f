// @ts-check
/** Spanish of the guided pages. */

/** @type {Record<string, string>} */
export const GUIDE = {
};
