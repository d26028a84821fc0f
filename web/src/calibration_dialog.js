// @ts-check
/** The calibration as a guided page: where to put the robot, its progress, its results, and the parameters before and after. */
import { dialog } from './dialog.js';
import { clickable, create, setText } from './dom.js';
import { numberAs, said, t } from './text.js';
import { format, formatFloat } from './units.js';

/** @typedef {import('./panel.js').Send} Send */
/** @typedef {import('./types.js').Parameter} Parameter */
/** @typedef {import('./types.js').State} State */

/** About how long it takes [s]. */
const ABOUT_S = 150;

export class CalibrationDialog {
  #send;
  #made = dialog('calibration-dialog', t('Calibrate'));
  #body = create('div', { className: 'stack', id: 'calibration-step' });
  #progress = create('progress', { max: ABOUT_S, value: 0 });
  #since = create('output');
  /** The parameters as they are. @type {Parameter[]} */
  #parameters = [];
  /** What is shown now. */
  #shown = '';
  /** @type {State | null} */
  #state = null;

  /** @param {Send} send */
  constructor(send) {
    this.#send = send;
    this.#made.body.append(this.#body);
    this.#progress.setAttribute('aria-label', t('Calibrate'));
  }

  open() {
    this.#shown = '';
    this.#layOut(this.#state?.calibration?.phase === 'running' ? 'running' : 'begin');
    this.#made.open();
  }

  /** @param {Parameter[]} parameters */
  setParameters(parameters) {
    this.#parameters = parameters;
  }

  /** @param {State} state */
  show(state) {
    const known = this.#state?.calibration;
    this.#state = state;
    const { calibration } = state;
    if (calibration?.phase === 'running') {
      this.#layOut('running');
      const passed_s = Math.max(0, state.t_s - calibration.since_s);
      this.#progress.value = passed_s;
      setText(this.#since, t('{} s of about {} s', format(passed_s, 0), ABOUT_S));
    } else if (calibration && (calibration.number !== known?.number || calibration.phase !== known.phase)) {
      // One that ended at once was never shown as running; the one before may have ended the same way.
      this.#shown = '';
      this.#layOut(calibration.phase);
    } else if (!calibration && this.#shown === 'running') {
      // The robot was moved in the meantime.
      this.#layOut('begin');
    }
  }

  /** @param {'begin' | 'running' | 'done' | 'failed'} phase */
  #layOut(phase) {
    if (phase === this.#shown) return;
    this.#shown = phase;
    const parts = { begin: () => this.#begin(), running: () => this.#running(), done: () => this.#done(), failed: () => this.#failed() }[phase]();
    this.#body.replaceChildren(...parts);
  }

  /** @param {string} text @param {() => void} act @param {string} [kind] */
  #button(text, act, kind = '') {
    return clickable({ textContent: text, className: kind }, act);
  }

  #begin() {
    const start = this.#button(t('Begin the calibration'), () => this.#send({ type: 'calibrate' }), 'go');
    const put = this.#state?.simulated
      ? [this.#button(t('Put the simulated robot there'), () => this.#send({ type: 'reset', scenario: 'calibration', world: null, rig: null, seed: 1 }))] : [];
    return [
      create('p', { textContent: t('The robot finds out by itself: the duty at which each wheel starts, the duty for each speed, the ratio of the wheels\' radii, and the distance between the wheels.') }),
      create('ol', {}, ...[
        t('A sonar ahead on the servo and one on each side: sensor layout final. Battery charged.'),
        t('Put it on the floor beside a straight wall, 0.3 to 0.5 m from it and along it, with 2.5 m free ahead.'),
        t('It drives to and fro along the wall and turns on the spot, for about two and a half minutes. STOP ends it at any moment.'),
      ].map((textContent) => create('li', { textContent }))),
      create('div', { className: 'row' }, start, ...put),
    ];
  }

  #running() {
    return [create('p', { textContent: t('The robot calibrates itself. Stay out of its way; STOP ends it.') }), create('div', { className: 'row' }, this.#progress, this.#since)];
  }

  #failed() {
    const { calibration } = this.#state ?? {};
    const why = calibration?.phase === 'failed' ? said(calibration.why) : '';
    return [create('p', { className: 'failed', textContent: t('The calibration came to no end: {}', why) }), create('div', { className: 'row' }, this.#button(t('Begin again'), () => this.#layOut('begin'), 'go'))];
  }

  #done() {
    const { calibration } = this.#state ?? {};
    const { rows = [], parameters = [], before = [] } = calibration?.phase === 'done' ? calibration.findings : {};
    const named = (/** @type {number} */ id) => this.#parameters.find((each) => each.id === id)?.name ?? String(id);
    // A log of an earlier version is without them.
    const was = new Map(before);
    const found = rows.map(({ name, found: value, standard_error }) => [said(name), numberAs(value.toPrecision(5)), standard_error === null ? '' : `± ${numberAs(standard_error.toPrecision(2))}`]);
    const set = parameters.map(([id, value]) => [named(id), formatFloat(was.get(id) ?? null), formatFloat(value)]);
    const back = this.#button(t('Put the old values back'), () => {
      for (const [id, value] of before) this.#send({ type: 'set_param', id, value });
      this.#made.dialog.close();
    });
    return [
      create('p', { className: 'passed', textContent: t('Done. The parameters are set; save them to make that last.') }),
      create('div', { className: 'help-lists' }, table([t('found'), t('value'), t('standard error')], found), table([t('parameter'), t('before'), t('now')], set)),
      create('div', { className: 'row' }, this.#button(t('Save on the robot'), () => this.#send({ type: 'save_params' }), 'go'), back),
    ];
  }
}

/** @param {string[]} head @param {string[][]} lines */
function table(head, lines) {
  return create('table', {}, create('thead', {}, create('tr', {}, ...head.map((textContent) => create('th', { textContent })))),
    create('tbody', {}, ...lines.map((line) => create('tr', {}, ...line.map((textContent) => create('td', { textContent }))))));
}
