// @ts-check
/** The displays at a robot's pins: what they show, and how it is drawn. */
import { create } from './dom.js';

/** Characters that a program draws itself are the letters from here on: the private use area of Unicode. */
const OWN = 0xE000;
/** Dots of such a character, each row a byte. */
const OWN_COLUMNS = 5;
const OWN_ROWS = 8;

/**
 * @typedef {{columns: number, dots: string}} Dots Rows of dots, eight in a byte, in hexadecimal.
 * @typedef {{rows: string[], drawn: Record<string, string>, light: boolean}} Letters Rows of letters, the program's own ones by their dots.
 */

/** What the displays show, by name, of lines `name=content`. @param {string} text @returns {Map<string, Dots | Letters>} */
export function contentsOf(text) {
  const lines = text.split('\n').filter((line) => line.includes('='));
  return new Map(lines.map((line) => [line.slice(0, line.indexOf('=')), JSON.parse(line.slice(line.indexOf('=') + 1))]));
}

/** The bits of bytes in hexadecimal, the highest of each first. @param {string} dots */
export const bitsOf = (dots) => [...dots].flatMap((digit) => [8, 4, 2, 1].map((bit) => (Number.parseInt(digit, 16) & bit) !== 0));

/** Letters for a screen reader. @param {string} row */
export const spoken = (row) => [...row].map((letter) => (isOwn(letter) ? '▯' : letter)).join('').trimEnd();

/** @param {string} letter */
const isOwn = (letter) => letter.charCodeAt(0) >= OWN && letter.charCodeAt(0) < OWN + 8;

/** @param {HTMLCanvasElement} canvas @param {boolean[]} bits @param {number} columns */
function paint(canvas, bits, columns) {
  const rows = Math.floor(bits.length / columns);
  Object.assign(canvas, { width: columns, height: rows });
  const context = canvas.getContext('2d');
  if (context === null) return;
  context.fillStyle = getComputedStyle(canvas).color;
  bits.forEach((lit, index) => lit && context.fillRect(index % columns, Math.floor(index / columns), 1, 1));
}

/** Draws rows of dots. @param {HTMLCanvasElement} canvas @param {Dots} content */
export const drawDots = (canvas, { columns, dots }) => paint(canvas, bitsOf(dots), columns);

/** A character that a program draws. @param {string} dots */
function drawOwn(dots) {
  const canvas = create('canvas', { className: 'own-letter' });
  const rows = Array.from({ length: OWN_ROWS }, (_, row) => bitsOf(dots.slice(2 * row, 2 * row + 2)).slice(-OWN_COLUMNS));
  paint(canvas, rows.flat(), OWN_COLUMNS);
  return canvas;
}

/** Draws rows of letters. @param {HTMLElement} panel @param {Letters} content */
export function drawLetters(panel, { rows, drawn, light }) {
  panel.classList.toggle('unlit', !light);
  panel.setAttribute('aria-label', rows.map(spoken).join('\n'));
  panel.replaceChildren(...rows.map((row) => {
    const letters = [...row].map((letter) => (isOwn(letter) ? drawOwn(drawn[letter.charCodeAt(0) - OWN] ?? '') : letter));
    return create('div', {}, ...letters);
  }));
}
