// @ts-check
/**
 * The colours of canvases, from the style sheet, dark or light as the system is. Left, right and the states are
 * distinguishable for colour-blind people too (Okabe and Ito, 2008).
 */
const NAMES = /** @type {const} */ ([
  'text', 'dim', 'grid', 'line', 'panel', 'left', 'right', 'front', 'reference', 'bad', 'wall', 'robot', 'goal', 'lamp', 'state-0', 'state-1', 'state-2',
  'state-3', 'state-4', 'state-5',
]);

/** @typedef {typeof NAMES[number]} ColourName */

/** @type {Record<ColourName, string>} */
export const colours = /** @type {Record<ColourName, string>} */ ({});

function read() {
  const style = getComputedStyle(document.documentElement);
  for (const name of NAMES) colours[name] = style.getPropertyValue(`--${name}`).trim();
}

/** @type {Set<() => void>} */
const listeners = new Set();

/**
 * Called when the system changes between dark and light.
 * @param {() => void} listener
 */
export function onThemeChange(listener) {
  listeners.add(listener);
}

read();
matchMedia('(prefers-color-scheme: light)').addEventListener('change', () => {
  read();
  for (const listener of listeners) listener();
});

/** How many colours states have. */
export const STATE_COLOURS = 6;

/**
 * The colour of a state of a mode.
 * @param {number} state
 */
export function stateColour(state) {
  return colours[/** @type {ColourName} */ (`state-${state % STATE_COLOURS}`)];
}
