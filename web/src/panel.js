// @ts-check
/** The command panel: mode, ON and OFF, STOP, and the controls of the mode. */
import { number, read } from './decimal.js';
import { clickable, create, element, setText } from './dom.js';
import { Joystick } from './joystick.js';
import { Movements } from './movements.js';
import { isOwn } from './program.js';
import { Places } from './places.js';
import { Steering } from './steering.js';
import { CM_PER_M, RPM_PER_RAD_S, format } from './units.js';
import { named, said, t } from './text.js';

/** @typedef {import('./types.js').ModeEntry} ModeEntry */
/** @typedef {import('./types.js').Scene} Scene */
/** @typedef {import('./types.js').State} State */
/** @typedef {(order: import('./types.js').Order) => void} Send */

/** A robot that has not taken its scenario's mode by then has another one [ms]. */
const STARTS_MS = 5_000;

export class CommandPanel {
  #send;
  #modes = element('modes', HTMLDivElement);
  #about = element('about', HTMLSpanElement);
  #reference = element('reference', HTMLFormElement);
  #armed = element('armed', HTMLOutputElement);
  #experiment = element('mode-scenario', HTMLButtonElement);
  /** @type {Scene | null} */
  #scene = null;
  #movements;
  #joystick;
  #steering;
  #places;
  /** @type {ModeEntry[]} */
  #entries = [];
  /** The mode the panel is laid out for. @type {number | null} */
  #shown = null;
  /** When another scenario began. */
  #starts_ms = -STARTS_MS;
  /** @type {HTMLOutputElement | null} */
  #inForce = null;

  /** @param {Send} send @param {import('./map.js').WorldMap} map */
  constructor(send, map) {
    this.#send = send;
    this.#movements = new Movements(send);
    this.#joystick = new Joystick(send);
    this.#steering = new Steering(() => send({ type: 'stop' }));
    this.#places = new Places(send, map);
    element('stop', HTMLButtonElement).addEventListener('click', () => send({ type: 'stop' }));
    element('on', HTMLButtonElement).addEventListener('click', () => {
      // What is drawn on the map is meant.
      this.#places.sendDraft();
      send({ type: 'arm' });
    });
    this.#experiment.addEventListener('click', () => {
      if (this.#scene) send({ type: 'reset', scenario: this.#experiment.value, world: null, rig: null, seed: this.#scene.choice.seed });
    });
    element('off', HTMLButtonElement).addEventListener('click', () => send({ type: 'disarm' }));
    // Space stops, wherever the focus is, before any other effect there. Only in a text field it is a space.
    for (const type of /** @type {const} */ (['keydown', 'keyup'])) {
      addEventListener(type, (event) => {
        const typing = event.target instanceof HTMLTextAreaElement || (event.target instanceof HTMLInputElement && event.target.type === 'text' && event.target.inputMode !== 'decimal')
          || (event.composedPath()[0] instanceof HTMLElement && /** @type {HTMLElement} */ (event.composedPath()[0]).isContentEditable);
        if (event.code !== 'Space' || typing) return;
        event.preventDefault();
        event.stopPropagation();
        if (type === 'keydown' && !event.repeat) send({ type: 'stop' });
      }, { capture: true });
    }
  }

  /** @param {ModeEntry[]} modes */
  setModes(modes) {
    this.#entries = modes;
    this.#shown = null;
    this.#modes.replaceChildren(...modes.map((mode) => clickable({ value: String(mode.id) }, () => this.#send({ type: 'mode', mode: mode.id }),
      create('b', { textContent: String(mode.id) }), named(mode.name))));
  }

  /** @param {Scene | null} scene */
  setScene(scene) {
    const begins = this.#scene !== null;
    this.#scene = scene?.of_ghost ? null : scene;
    this.#places.setScene(scene);
    // The robot starts first, then takes the mode of the scenario: what is clicked on the map meanwhile counts.
    const mode = this.#scene?.experiments.find(({ name }) => name === this.#scene?.choice.scenario)?.mode;
    const entry = this.#entries.find(({ id }) => id === mode);
    if (!begins || !entry) return;
    this.#starts_ms = performance.now();
    this.#lay(entry);
  }

  /** The mode shown. @type {ModeEntry | null} */
  mode = null;

  /** @param {State} state */
  show(state) {
    const { mode, armed, fault } = state.robot;
    const entry = this.#entries.find((each) => each.id === mode) ?? null;
    this.mode = entry;
    for (const button of this.#modes.querySelectorAll('button')) {
      const own = this.#entries.find((each) => String(each.id) === button.value);
      button.setAttribute('aria-pressed', String(button.value === String(mode)));
      button.disabled = armed && button.value !== String(mode);
      button.title = button.disabled ? t('Switch OFF first') : said(own?.about ?? '');
    }
    const own = isOwn(state);
    const cut = state.motors_cut === true;
    setText(this.#armed, own ? t(cut ? 'motors without supply' : 'motors supplied') : fault ? t('fault') : armed ? t('armed') : t('off'));
    document.body.classList.toggle('armed', armed);
    this.#armed.className = `chip ${fault || (own && cut) ? 'bad' : armed || own ? 'good' : ''}`;
    this.#movements.show(entry?.movements ?? false, armed);
    this.#joystick.show(entry?.velocity ?? false, armed);
    const steered = entry?.movements ? this.#movements : entry?.velocity ? this.#joystick : null;
    this.#steering.give(armed && steered ? steered.steer : null);
    if (this.#shown === mode || armed) this.#starts_ms = -STARTS_MS;
    if (this.#shown !== mode && entry && performance.now() - this.#starts_ms > STARTS_MS) this.#lay(entry);
    this.#showReference(state, entry);
    if (own) setText(this.#about, this.#about.title = t('STOP and OFF cut the supply of the motors, ON gives it back; the program gets them as text, too'));
    else if (entry) this.#showAbout(entry, state.robot.rig);
    const scenario = armed || !entry ? null : this.#scenarioOf(entry);
    this.#experiment.hidden = scenario === null;
    if (scenario !== null) {
      this.#experiment.value = scenario;
      setText(this.#experiment, t('Load a scenario of this mode'));
    }
  }

  /** The simulation runs another mode's experiment, whose world and sonars may not fit this one: offers this mode's first. @param {ModeEntry} mode */
  #scenarioOf(mode) {
    if (!this.#scene || mode.movements) return null;
    const own = this.#scene.experiments.filter((each) => each.mode === mode.id && each.shows_mode).map(({ name }) => name);
    return own.includes(this.#scene.choice.scenario) ? null : own[0] ?? null;
  }

  /** What the mode does, or what it lacks. @param {ModeEntry} mode @param {string | null} rig The robot's. */
  #showAbout(mode, rig) {
    const about = said(mode.about);
    const fits = rig === null || mode.rigs.includes(rig);
    setText(this.#about, fits ? about : t('needs the sensor layout {}', mode.rigs.map(named).join(' | ')));
    if (this.#about.title !== about) this.#about.title = about;
  }

  /** @param {State} state @param {ModeEntry | null} mode */
  #showReference(state, mode) {
    if (!this.#inForce) return;
    const [left, right] = state.robot.reference;
    const kind = mode?.reference?.kind;
    if (kind === 'distance') setText(this.#inForce, t('now {} cm', format(left * CM_PER_M)));
    if (kind === 'speed') setText(this.#inForce, t('now {} rpm', format(left * RPM_PER_RAD_S, 0)));
    if (kind === 'wheel_speed') setText(this.#inForce, t('now {} rpm', `${format(left * RPM_PER_RAD_S, 0)} | ${format(right * RPM_PER_RAD_S, 0)}`));
  }

  /** @param {ModeEntry} mode */
  #lay(mode) {
    this.#shown = mode.id;
    this.#layOut(mode);
    this.#places.layOut(mode);
  }

  /** @param {ModeEntry} mode */
  #layOut(mode) {
    this.#inForce = create('output', { className: 'hint' });
    const reference = mode.reference?.commanded ? mode.reference : null;
    this.#reference.hidden = reference === null || reference.kind === 'goal';
    this.#reference.replaceChildren();
    this.#reference.onsubmit = (event) => event.preventDefault();
    if (reference?.kind === 'distance') {
      this.#layOutOne('reference-cm', 'cm', CM_PER_M, reference);
    } else if (reference?.kind === 'speed') {
      this.#layOutOne('reference-rpm', 'rpm', RPM_PER_RAD_S, reference);
    } else if (reference?.kind === 'wheel_speed') {
      this.#layOutSpeeds(reference);
    } else {
      this.#inForce = null;
    }
  }

  /**
   * @param {string} id
   * @param {string} unit
   * @param {number} factor From the SI unit.
   * @param {import('./types.js').Reference} reference
   */
  #layOutOne(id, unit, factor, { min, max, offered }) {
    const input = number(id, tenths(offered * factor), min * factor, max * factor);
    const range = create('span', { className: 'hint', textContent: t('{} to {} {}', format(min * factor, 0), format(max * factor, 0), unit) });
    this.#reference.replaceChildren(create('label', {}, `${t('setpoint')} `, input, ` ${unit}`), submit(t('Set')), this.#inForce ?? '', range);
    this.#reference.onsubmit = (event) => {
      event.preventDefault();
      this.#send({ type: 'reference', value: read(input) / factor });
    };
  }

  /** @param {import('./types.js').Reference} reference */
  #layOutSpeeds({ min, max, offered }) {
    const field = (/** @type {string} */ id) => number(id, tenths(offered * RPM_PER_RAD_S), min * RPM_PER_RAD_S, max * RPM_PER_RAD_S);
    const left = field('reference-left-rpm');
    const right = field('reference-right-rpm');
    const both = create('input', { type: 'checkbox', id: 'reference-both', checked: true });
    const tie = () => {
      right.disabled = both.checked;
      if (both.checked) right.value = left.value;
    };
    both.addEventListener('change', tie);
    left.addEventListener('input', tie);
    tie();
    this.#reference.replaceChildren(
      create('label', {}, `${t('left')} `, left), create('label', {}, `${t('right')} `, right), ' rpm',
      create('label', {}, both, ` ${t('both')}`), submit(t('Set')), this.#inForce ?? '',
    );
    this.#reference.onsubmit = (event) => {
      event.preventDefault();
      this.#send({ type: 'wheel_reference', left: read(left) / RPM_PER_RAD_S, right: read(right) / RPM_PER_RAD_S });
    };
  }
}

/** As a person would write it. @param {number} value */
const tenths = (value) => Math.round(value * 10) / 10;

/** @param {string} text */
function submit(text) {
  return create('button', { type: 'submit', textContent: text });
}
