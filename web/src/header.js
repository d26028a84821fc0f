// @ts-check
/** The top line: what runs, its speed, and the quality of the link. */
import { create, element, setText } from './dom.js';
import { isOwn, phaseWords } from './program.js';
import { format, formatShort } from './units.js';
import { named, said, t } from './text.js';

/** @typedef {import('./types.js').State} State */
/** @typedef {import('./types.js').Scene} Scene */
/** @typedef {import('./panel.js').Send} Send */

const SPEEDS = [0, 0.1, 0.25, 0.5, 1, 2, 4, 8, 16];
/** The scenario's own world or rig. */
const OWN = '';
/** The world that was edited here: `EDITED` of `crates/lab`. */
export const EDITED = 'edited';
/** Without a message from the server for this long, the display is stale [ms]. */
const STALE_MS = 1_500;

export class Header {
  #form = element('simulation', HTMLFormElement);
  #scenario = element('scenario', HTMLSelectElement);
  #world = element('world', HTMLSelectElement);
  #rig = element('rig', HTMLSelectElement);
  #seed = element('seed', HTMLInputElement);
  #speed = element('speed', HTMLSelectElement);
  #connection = element('connection', HTMLSpanElement);
  #roundTrip = element('round-trip', HTMLOutputElement);
  #load = element('load', HTMLOutputElement);
  #crc = element('crc', HTMLOutputElement);
  #battery = element('battery', HTMLOutputElement);
  #batteryChip = element('battery-chip', HTMLSpanElement);
  /** @type {State | null} */
  #state = null;
  #open = false;
  #received_ms = 0;

  /** @param {Send} send */
  constructor(send) {
    this.#speed.replaceChildren(...SPEEDS.map((factor) => option(String(factor), factor === 0 ? t('paused') : `× ${formatShort(factor)}`)));
    this.#speed.addEventListener('change', () => send({ type: 'speed', factor: Number(this.#speed.value) }));
    this.#form.addEventListener('submit', (event) => {
      event.preventDefault();
      send({ type: 'reset', scenario: this.#scenario.value, world: this.#world.value === OWN ? null : this.#world.value, rig: this.#rig.value === OWN ? null : this.#rig.value, seed: this.#seed.valueAsNumber });
    });
    // A scenario brings its own world and sensors; it begins disarmed.
    this.#scenario.addEventListener('change', () => send({ type: 'reset', scenario: this.#scenario.value, world: null, rig: null, seed: this.#seed.validity.valid ? this.#seed.valueAsNumber : 1 }));
    setInterval(() => this.#showConnection(), STALE_MS / 3);
  }

  /** @param {Scene | null} scene */
  setScene(scene) {
    this.#form.hidden = scene === null;
    if (!scene) return;
    this.#scenario.replaceChildren(...grouped(scene.experiments));
    this.#world.replaceChildren(option(OWN, t('scenario default')), ...scene.worlds.map((name) => option(name, name === EDITED ? t('edited: {}', titleWords(scene.world_titles?.[name] ?? '')) : titleWords(scene.world_titles?.[name] ?? name))));
    this.#rig.replaceChildren(option(OWN, t('scenario default')), ...scene.rigs.map((name) => option(name, named(name))));
    this.#rig.title = named(scene.rig);
    this.#scenario.value = scene.choice.scenario;
    this.#scenario.title = scene.choice.scenario;
    this.#world.value = scene.choice.world ?? OWN;
    this.#world.title = scene.choice.world ?? '';
    this.#rig.value = scene.choice.rig ?? OWN;
    this.#seed.value = String(scene.choice.seed);
  }

  /** @param {boolean} open */
  setOpen(open) {
    this.#open = open;
    this.received();
  }

  /** A message has arrived from the server. */
  received() {
    this.#received_ms = performance.now();
    this.#showConnection();
  }

  /** @param {State} state */
  show(state) {
    this.#state = state;
    const speed = String(state.speed);
    if (![...this.#speed.options].some((each) => each.value === speed)) this.#speed.append(option(speed, `× ${formatShort(state.speed)}`));
    if (document.activeElement !== this.#speed) this.#speed.value = speed;
    const { link, robot } = state;
    setText(this.#roundTrip, link.round_trip_ms === null ? '–' : `${link.round_trip_ms} ms`);
    setText(this.#load, `↓ ${format(link.down_load * 100, 0)} ↑ ${format(link.up_load * 100, 0)} %`);
    setText(this.#crc, `${link.crc_errors_down} | ${link.crc_errors_up}`);
    this.#crc.classList.toggle('bad', link.crc_errors_down + link.crc_errors_up > 0);
    const volts = robot.battery_v ?? robot.true_battery_v;
    setText(this.#battery, volts === null ? '–' : `${format(volts)} V`);
    this.#batteryChip.title = robot.battery_v !== null ? t('Battery, as the robot measures it')
      : robot.true_battery_v !== null ? t('Battery of the simulation; the robot has nothing wired to measure it') : t('The robot has nothing wired to measure its battery');
    this.#showConnection();
  }

  #showConnection() {
    const [text, level] = this.#connectionWords();
    setText(this.#connection, text);
    this.#connection.className = `chip ${level}`;
    document.body.classList.toggle('stale', level === 'bad');
  }

  /** @returns {[string, string]} */
  #connectionWords() {
    const state = this.#state;
    if (!this.#open) return [t('no connection'), 'bad'];
    if (!state) return [t('connecting…'), 'bad'];
    if (state.replay) return state.speed === 0 ? [t('replay, paused'), 'warning'] : [t('replay × {}', state.speed), 'good'];
    if (state.speed === 0) return [t('simulation paused'), 'warning'];
    if (state.program?.held?.stands) return phaseWords(state);
    if (performance.now() - this.#received_ms > STALE_MS) return [t('the station is silent'), 'bad'];
    if (isOwn(state)) return phaseWords(state);
    if (!state.link.connected) return [t('no answer from the robot'), 'bad'];
    const slow = state.simulated && state.achieved_speed > 0 && state.achieved_speed < 0.9 * state.speed;
    const rate = t('live {} Hz', format(state.link.telemetry_hz, 0));
    return slow ? [t('{}, only × {}', rate, format(state.achieved_speed)), 'warning'] : [rate, 'good'];
  }
}

/** Scenarios by their titles, below the headings of their groups. @param {Scene['experiments']} experiments */
export function grouped(experiments) {
  /** @type {Map<string | null, HTMLElement>} */
  const groups = new Map();
  /** @type {HTMLElement[]} */
  const made = [];
  for (const { name, title, group } of experiments) {
    const each = option(name, titleWords(title));
    const into = groups.get(group);
    if (into) into.append(each);
    else if (group === null) made.push(each);
    else {
      const heading = create('optgroup', { label: said(group) }, each);
      groups.set(group, heading);
      made.push(heading);
    }
  }
  return made;
}

/** The title of a scenario or a world. @param {string} title */
export const titleWords = (title) => said(title).replaceAll('->', '→');

/**
 * @param {string} value
 * @param {string} text
 */
function option(value, text) {
  return create('option', { value, textContent: text });
}
