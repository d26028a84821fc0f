// @ts-check
/** The field of a parameter's value, as its type asks for: a number, a switch, or one of several. All are numbers on the link. */
import { check, decimal, read, setLimits } from './decimal.js';
import { create } from './dom.js';
import { named } from './text.js';
import { formatFloat } from './units.js';

/** @typedef {import('./types.js').Parameter} Parameter */

/**
 * @typedef {object} ValueField
 * @property {HTMLElement} element
 * @property {(value: number | null) => string} text What the field holds for a value; null: not known.
 * @property {() => string} held What it holds.
 * @property {(text: string) => void} hold
 * @property {() => number} read NaN: no value.
 * @property {(parameter: Parameter) => void} limit
 */

/** @param {Parameter} parameter @returns {ValueField} */
export function valueField(parameter) {
  const id = `parameter-${parameter.name}`;
  if (parameter.type === 'switch') return switchField(id);
  return parameter.type === 'choice' ? choiceField(id, parameter.choices) : numberField(id);
}

/** @param {string} id @returns {ValueField} */
function numberField(id) {
  const element = decimal(id);
  return {
    element,
    text: formatFloat,
    held: () => element.value,
    hold(text) {
      element.value = text;
      check(element);
    },
    read: () => read(element),
    // A value that has not been read yet is not wrong.
    limit: ({ min, max, value }) => setLimits(element, min, max, value !== null),
  };
}

/** @param {string} id @returns {ValueField} */
function switchField(id) {
  const element = create('input', { type: 'checkbox', id, indeterminate: true });
  const held = () => (element.indeterminate ? '' : String(Number(element.checked)));
  return {
    element,
    text: (value) => (value === null ? '' : String(Number(value > 0.5))),
    held,
    hold(text) {
      element.indeterminate = text === '';
      element.checked = text === '1';
    },
    read: () => number(held()),
    limit() {},
  };
}

/** @param {string} id @param {string[]} choices @returns {ValueField} */
function choiceField(id, choices) {
  const element = create('select', { id }, ...choices.map((name, value) => create('option', { value: String(value), textContent: named(name) })));
  element.selectedIndex = -1;
  return {
    element,
    text: (value) => (value === null ? '' : String(Math.round(value))),
    held: () => element.value,
    hold(text) {
      element.value = text;
    },
    read: () => number(element.value),
    limit() {},
  };
}

/** @param {string} text */
const number = (text) => (text === '' ? NaN : Number(text));

/** A value as people read it. @param {Parameter} parameter @param {number} value */
export function valueWords({ type, choices }, value) {
  return type === 'number' ? formatFloat(value) : named(choices[Math.round(value)] ?? '');
}

/** What is allowed, for people; for a choice, the field shows it. @param {Parameter} parameter */
export function rangeWords(parameter) {
  return parameter.type === 'number' ? `${formatFloat(parameter.min)} … ${formatFloat(parameter.max)}` : '';
}
