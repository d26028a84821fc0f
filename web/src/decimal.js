// @ts-check
/**
 * Fields for numbers, which take a point or a comma whatever the page's language: a browser's own take what the browser's language has. Up and
 * down change the last decimal.
 */
import { create } from './dom.js';
import { t } from './text.js';
import { format, formatFloat, parse } from './units.js';

/** Limits of a field; null: none. @typedef {{min: number | null, max: number | null, required: boolean}} Limits */

/** @type {WeakMap<HTMLInputElement, Limits>} */
const limits = new WeakMap();

/** A field without limits, which may be empty. @param {string} id */
export function decimal(id) {
  const input = create('input', { type: 'text', id, className: 'decimal', inputMode: 'decimal', autocomplete: 'off', spellcheck: false, maxLength: 20 });
  limits.set(input, { min: null, max: null, required: false });
  input.addEventListener('input', () => check(input));
  input.addEventListener('keydown', (event) => {
    const up = event.key === 'ArrowUp' ? 1 : event.key === 'ArrowDown' ? -1 : 0;
    if (up === 0 || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    step(input, up);
  });
  return input;
}

/**
 * A field for a number within limits, in steps of a tenth at least.
 * @param {string} id
 * @param {number} value
 * @param {number} min
 * @param {number} max
 */
export function number(id, value, min, max) {
  const input = decimal(id);
  setLimits(input, Math.ceil(min * 10) / 10, Math.floor(max * 10) / 10);
  write(input, value);
  return input;
}

/** @param {HTMLInputElement} input @param {number} min @param {number} max @param {boolean} [required] */
export function setLimits(input, min, max, required = true) {
  limits.set(input, { min, max, required });
  check(input);
}

/** The number in a field; NaN if there is none. @param {HTMLInputElement} input */
export const read = (input) => parse(input.value);

/** @param {HTMLInputElement} input @param {number} value */
export function write(input, value) {
  input.value = formatFloat(value);
  check(input);
}

/** Marks an invalid field for the browser, so that its form is not sent. @param {HTMLInputElement} input */
export function check(input) {
  const { min, max, required } = limits.get(input) ?? { min: null, max: null, required: false };
  const value = read(input);
  const empty = input.value.trim() === '';
  const within = min === null || max === null || (value >= min && value <= max);
  const right = empty ? !required : within && !Number.isNaN(value);
  input.setCustomValidity(right ? '' : min === null || max === null ? t('a number') : t('a number from {} to {}', formatFloat(min), formatFloat(max)));
}

/** @param {HTMLInputElement} input @param {number} up One step up, or down. */
function step(input, up) {
  const value = read(input);
  if (Number.isNaN(value) || /e/i.test(input.value)) return;
  const decimals = input.value.match(/[.,](\d*)$/)?.[1]?.length ?? 0;
  const { min, max } = limits.get(input) ?? { min: null, max: null };
  const next = Math.min(max ?? Infinity, Math.max(min ?? -Infinity, value + up / 10 ** decimals));
  input.value = format(next, decimals).replace('−', '-');
  input.dispatchEvent(new Event('input', { bubbles: true }));
}
