// @ts-check
/** Equations of control laws, as the control core describes them: read, and worked out with the numbers of an instant. No page is needed. */

/**
 * A part of an equation. `of`: a number, a name, parentheses, an operator or a function.
 * @typedef {{of: string, parts: Part[]}} Part
 */
/** A part with its value, and which of its parts decides it: of `min`, `max` and `clamp`. @typedef {{value: number, decides: number}} Worked */

const FUNCTIONS = ['min', 'max', 'abs', 'sqrt', 'sign', 'clamp', 'derivative', 'filter'];

/** @param {string} text @returns {Part} */
export function parse(text) {
  const tokens = text.match(/[\w.:]+|[^\s]/g) ?? [];
  let at = 0;
  const expect = (/** @type {string} */ token) => {
    if (tokens[at++] !== token) throw new Error(`${text}: ${token} is missing`);
  };
  /** @returns {Part} */
  const value = () => {
    const token = tokens[at++] ?? '';
    if (!/^[\w(-]/.test(token)) throw new Error(`${text}: a value is missing`);
    if (token === '-') return { of: 'negative', parts: [value()] };
    if (token === '(') {
      const inner = sum();
      expect(')');
      return { of: '(', parts: [inner] };
    }
    if (!FUNCTIONS.includes(token)) return { of: token, parts: [] };
    expect('(');
    const parts = [sum()];
    while (tokens[at] === ',') {
      at += 1;
      parts.push(sum());
    }
    expect(')');
    return { of: token, parts };
  };
  /** @param {string[]} operators @param {() => Part} operand @returns {Part} */
  const chain = (operators, operand) => {
    let left = operand();
    while (operators.includes(tokens[at] ?? '')) left = { of: tokens[at++] ?? '', parts: [left, operand()] };
    return left;
  };
  /** @returns {Part} */
  const sum = () => chain(['+', '-'], () => chain(['*', '/'], value));
  const whole = sum();
  if (at < tokens.length) throw new Error(`${text}: ${tokens[at]} is too much`);
  return whole;
}

/** The names in an equation. @param {Part} part @returns {string[]} */
export const namesIn = ({ of, parts }) => (parts.length > 0 ? parts.flatMap(namesIn) : /^[\d.]+$/.test(of) ? [] : [of]);

/**
 * Works out an equation; not a number where a name has no value.
 * @param {Part} part
 * @param {(name: string) => number} valueOf
 * @param {Map<Part, Worked>} [all] where the values of its parts go
 * @param {(part: Part, values: number[]) => number} [remember] works out functions that need earlier values
 * @returns {number}
 */
export function work(part, valueOf, all = new Map(), remember = () => NaN) {
  const { of, parts } = part;
  const values = parts.map((each) => work(each, valueOf, all, remember));
  const [a = NaN, b = NaN, c = NaN] = values;
  /** @type {Record<string, () => number>} */
  const does = {
    '(': () => a, negative: () => -a, '+': () => a + b, '-': () => a - b, '*': () => a * b, '/': () => a / b,
    min: () => Math.min(...values), max: () => Math.max(...values), abs: () => Math.abs(a), sqrt: () => Math.sqrt(a), sign: () => Math.sign(a),
    clamp: () => Math.min(c, Math.max(b, a)), derivative: () => remember(part, values), filter: () => remember(part, values),
  };
  const value = does[of]?.() ?? (/^[\d.]+$/.test(of) ? Number(of) : valueOf(of));
  const decides = of === 'clamp' ? (a > c ? 2 : a < b ? 1 : 0) : of === 'min' || of === 'max' ? values.indexOf(value) : -1;
  all.set(part, { value, decides: Number.isFinite(value) ? decides : -1 });
  return value;
}
