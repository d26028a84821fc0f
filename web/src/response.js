// @ts-check
/** The response of a signal to a step, as the metrics of the scenarios define it (`metrics/step.rs`). */

/** A signal's lines. @typedef {{t: number[], y: number[]}} Signal */
/** @typedef {{rise_s: number, overshoot: number, settling_s: number, steady_error: number, moving: number}} Response Not a number where it has not happened; `moving`: 1 while it changes on, by more than the band. */

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
  const mean = meanOf(steady);
  const half = Math.floor(steady.length / 2);
  const outside = within.lastIndexOf(false);
  const responds = span > band;
  return {
    rise_s: responds ? first(0.9) - first(0.1) : NaN,
    overshoot: arrives ? Math.max(0, ...progress.map((each) => each - span)) : NaN,
    settling_s: responds && within.at(-1) ? (times[outside] ?? from_s) - from_s : NaN,
    steady_error: Math.abs(mean - reference),
    moving: Number(Math.abs(meanOf(steady.slice(half)) - meanOf(steady.slice(0, half))) > band),
  };
}

/** @param {number[]} values */
const meanOf = (values) => values.reduce((sum, value) => sum + value, 0) / values.length;

/** Time within the band after which a step that goes on has settled [s]. */
const HELD_S = 1;

/**
 * How far a step is: there are figures once it has settled for good or something else came. What STOP, OFF or a fault ended
 * on its way was stopped.
 * @param {Pick<Response, 'settling_s' | 'moving'>} response
 * @param {{from_s: number, runs: boolean, stopped?: boolean}} step
 * @param {number} now_s
 * @returns {'running' | 'stopped' | 'over'}
 */
export function stage({ settling_s, moving }, { from_s, runs, stopped = false }, now_s) {
  const lasted_s = now_s - from_s;
  // The last part, over which the steady error is taken, lies in the band.
  const settled = settling_s <= Math.min(lasted_s - HELD_S, (1 - STEADY_SHARE) * lasted_s);
  if (runs && !settled) return 'running';
  return settled || !stopped || !moving ? 'over' : 'stopped';
}
