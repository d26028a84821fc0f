// @ts-check
/** *Run the experiment*: the scenario commands the robot; its progress, its verdict, and its limits as bands in the plots. */
import { copyButton, dialog } from './dialog.js';
import { create, element, setText } from './dom.js';
import { settlingBand } from './step.js';
import { t } from './text.js';
import { colours } from './theme.js';
import { CM_PER_M, RPM_PER_RAD_S, format, formatShort } from './units.js';

/** @typedef {import('../vendor/uplot/uPlot.js')} uPlot */

/** @typedef {import('./types.js').State} State */
/** @typedef {import('./types.js').Limit} Limit */
/** @typedef {import('./store.js').Store} Store */
/** What is drawn of a limit, in the plot's unit. @typedef {{from_s: number, to_s: number, low: number, high: number}} Band */

export class ExperimentPanel {
  #send;
  #play = element('play', HTMLButtonElement);
  #line = element('experiment', HTMLDivElement);
  #progress = element('experiment-progress', HTMLProgressElement);
  #words = element('experiment-words', HTMLOutputElement);
  #details = element('experiment-details', HTMLButtonElement);
  /** @type {ReturnType<typeof dialog> | null} */
  #dialog = null;
  /** @type {State | null} */
  #state = null;
  /** @type {import('./types.js').Scene | null} */
  #scene = null;

  /** @param {import('./panel.js').Send} send */
  constructor(send) {
    this.#send = send;
    this.#play.addEventListener('click', () => this.#send({ type: 'play' }));
    this.#details.addEventListener('click', () => this.#open());
  }

  /** @param {import('./types.js').Scene | null} scene */
  setScene(scene) {
    this.#scene = scene;
  }

  /** @param {State} state */
  show(state) {
    this.#state = state;
    const { experiment } = state;
    this.#line.hidden = !experiment;
    const running = experiment?.phase === 'running';
    this.#play.disabled = running;
    document.body.classList.toggle('played', experiment !== undefined);
    if (!experiment) return;
    this.#progress.hidden = this.#progress.max === 0 || !running;
    this.#progress.max = experiment.duration_s;
    this.#progress.value = Math.min(state.t_s, experiment.duration_s);
    this.#details.hidden = running || experiment.phase === 'stopped';
    const kept = experiment.limits.filter(({ kept }) => kept).length;
    const words = {
      running: () => t('{} of {} s', format(Math.min(state.t_s, experiment.duration_s), 0), format(experiment.duration_s, 0)),
      stopped: () => t('stopped, no verdict'),
      passed: () => t('passed: {} of {} limits kept', kept, experiment.limits.length),
      failed: () => t('failed: {} of {} limits kept', kept, experiment.limits.length),
    };
    setText(this.#words, words[experiment.phase]());
    this.#words.className = `chip ${experiment.phase === 'passed' ? 'good' : experiment.phase === 'failed' ? 'bad' : ''}`;
  }

  #open() {
    const experiment = this.#state?.experiment;
    if (!experiment) return;
    this.#dialog ??= dialog('experiment-dialog', t('The experiment and its limits'));
    const rows = experiment.limits.map(({ name, min, max, value, kept }) => create('tr', {},
      create('td', {}, create('code', { textContent: name })),
      create('td', { textContent: value === null ? t('never') : formatShort(Number(value.toPrecision(4))), className: kept ? '' : 'failed' }),
      create('td', { textContent: [min === null ? '' : t('at least {}', formatShort(min)), max === null ? '' : t('at most {}', formatShort(max))].filter(Boolean).join(', ') }),
      create('td', { textContent: kept ? `✓ ${t('kept')}` : `✗ ${t('missed')}`, className: kept ? 'passed' : 'failed' })));
    const head = ['metric', 'value', 'limit', 'result'].map((name) => create('th', { textContent: t(name), scope: 'col' }));
    const other = experiment.failures?.filter((line) => !experiment.limits.some(({ name }) => line.startsWith(name))) ?? [];
    const { scenario, seed = 1 } = this.#scene?.choice ?? {};
    const command = ['rumbo run', scenario, '--seed', seed, ...(experiment.parameters ?? []).map(([name, value]) => `--param ${name}=${Number(value.toPrecision(7))}`)].join(' ');
    this.#dialog.body.replaceChildren(
      create('div', { className: 'scroll', tabIndex: 0 }, create('table', {}, create('thead', {}, create('tr', {}, ...head)), create('tbody', {}, ...rows))),
      ...other.map((line) => create('p', { className: 'failed', textContent: line })),
      create('p', { className: 'hint' }, `${t('The same run on the command line:')} `, create('code', { textContent: command }), ' ', copyButton(command)));
    this.#dialog.open();
  }
}

/** What limits ask of a step: `step2.settling_s`, an overshoot, a steady error. @param {Store} store @param {import('./store.js').Step} step @param {number} number @param {Limit[]} limits @returns {Band[]} */
function bandsOf(store, step, number, limits) {
  const factor = step.kind === 'wheel_speed' ? RPM_PER_RAD_S : CM_PER_M;
  const max = (/** @type {string} */ what) => limits.find(({ name }) => name.startsWith(`step${number}.${what}`))?.max ?? null;
  const to_s = Math.min(step.until_s, store.experiment_end_s);
  const [settling_s, steady] = [max('settling_s'), max('steady_error')];
  return step.reference.flatMap((reference, wheel) => {
    if (step.kind === 'distance' && wheel > 0) return [];
    const around = (/** @type {number} */ by, /** @type {number} */ from_s) => ({ from_s, to_s, low: reference - by, high: reference + by });
    const band = settlingBand(store, step);
    return [...(settling_s === null ? [] : [around(band, step.from_s + settling_s)]), ...(steady === null ? [] : [around(steady * factor, step.from_s + 0.6 * (to_s - step.from_s))])];
  });
}

/** Shades each step of an experiment, with its number, and what its limits admit. @param {uPlot} plot @param {string} unit @param {Store} store @param {[number, number]} range_s */
export function drawExperiment(plot, unit, store, [from_s, to_s]) {
  const { ctx, bbox } = plot;
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  ctx.font = `${11 * devicePixelRatio}px system-ui, sans-serif`;
  store.steps.forEach((step, index) => {
    const end_s = Math.min(step.until_s, store.experiment_end_s);
    if (end_s < from_s || step.from_s > to_s) return;
    const x = (/** @type {number} */ t_s) => plot.valToPos(t_s, 'x', true);
    ctx.fillStyle = colours.dim;
    ctx.globalAlpha = index % 2 === 0 ? 0.1 : 0.04;
    ctx.fillRect(x(step.from_s), bbox.top, x(end_s) - x(step.from_s), bbox.height);
    ctx.globalAlpha = 1;
    ctx.fillText(String(index + 1), x(step.from_s) + 4 * devicePixelRatio, bbox.top + 12 * devicePixelRatio);
    if (unit !== (step.kind === 'wheel_speed' ? 'rpm' : step.kind === 'distance' ? 'cm' : '')) return;
    ctx.fillStyle = colours.front;
    ctx.globalAlpha = 0.22;
    for (const band of bandsOf(store, step, index + 1, store.limits ?? [])) {
      const [high, low] = [band.high, band.low].map((value) => plot.valToPos(value, 'y', true));
      ctx.fillRect(x(band.from_s), high ?? 0, Math.max(0, x(band.to_s) - x(band.from_s)), Math.max((low ?? 0) - (high ?? 0), 2 * devicePixelRatio));
    }
    ctx.globalAlpha = 1;
  });
  ctx.restore();
}
