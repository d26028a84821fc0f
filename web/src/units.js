// @ts-check
/**
 * Units for people: cm, rpm and degrees; everything received from the robot is SI. And numbers in the page's language: a
 * decimal comma in Spanish.
 */
import { language, numberAs } from './text.js';

export const RPM_PER_RAD_S = 60 / (2 * Math.PI);
export const CM_PER_M = 100;
export const DEG_PER_RAD = 180 / Math.PI;

/**
 * A number with a fixed count of decimals and a real minus sign, or a dash where there is none.
 * @param {number | null | undefined} value
 * @param {number} [decimals]
 */
export function format(value, decimals = 1) {
  if (value === null || value === undefined || !Number.isFinite(value)) return '–';
  return numberAs(value.toFixed(decimals)).replace(/^-(?=.*[1-9])/, '−').replace(/^-/, '');
}

/**
 * A number with as many decimals as it needs, at most `digits` digits in all.
 * @param {number} value
 * @param {number} [digits]
 */
export function formatShort(value, digits = 12) {
  return numberAs(String(Number(value.toPrecision(digits)))).replace(/^-/, '−');
}

/**
 * The shortest text for a value that crossed the link as a 32-bit float, as it can be typed.
 * @param {number | null} value
 */
export function formatFloat(value) {
  return value === null ? '' : numberAs(String(Number(value.toPrecision(6))));
}

/** Two numbers as a position, unambiguous even with decimal commas. @param {string} x @param {string} y */
export function pair(x, y) {
  return `(${x}${language === 'es' ? ';' : ','} ${y})`;
}

/** A number as people type it, with a point or a comma; NaN if it is none. @param {string} text */
export function parse(text) {
  const plain = text.trim().replace(',', '.').replace('−', '-');
  return /^[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?$/i.test(plain) ? Number(plain) : NaN;
}
