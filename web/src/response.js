// @ts-check
/** The response of a signal to a step, as the metrics of the scenarios define it (`metrics/step.rs`). */

/** A signal's lines. @typedef {{t: number[], y: number[]}} Signal */
/** @typedef {{rise_s: number, overshoot: number, settling_s: number, steady_error: number}} Response Not a number where it has not happened. */

/** Share of a step, at its end, over which the steady error is taken. */
const STEADY_SHARE = 0.4;

/**
 * How a signal responded to a step that began at `from_s`, up to its last line.
 * @param {Signal} signal
 * @param {number} from_s
 * @param {number} reference
 * @param {(span: number) => number} bandOf
 * @returns {Response}
 */
export function response({ t: times, y }, from_s, reference, bandOf) {
  const [start = NaN] = y;
  const span = Math.abs(reference - start);
  const band = bandOf(span);
  const progress = y.map((value) => (reference < start ? start - value : value - start));
  const within = y.map((value) => Math.abs(value - reference) <= band);
  const first = (/** @type {number} */ level) => times[progress.findIndex((each) => each >= level * span)] ?? NaN;
  const arrives = within.includes(true) || progress.some((each) => each >= span);
  const steady = y.slice(Math.floor(y.length * (1 - STEADY_SHARE)));
  const mean = steady.reduce((sum, value) => sum + value, 0) / steady.length;
  const outside = within.lastIndexOf(false);
  const responds = span > band;
  return {
    rise_s: responds ? first(0.9) - first(0.1) : NaN,
    overshoot: arrives ? Math.max(0, ...progress.map((each) => each - span)) : NaN,
    settling_s: responds && within.at(-1) ? (times[outside] ?? from_s) - from_s : NaN,
    steady_error: Math.abs(mean - reference),
  };
}
