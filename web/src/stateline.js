// @ts-check
/** The line with the robot's activity: state, heading, goal and distance, reached or not; or the fault, and a wrong rig. */
import { create, element, setText } from './dom.js';
import { compose, near, wrapped } from './geometry.js';
import { inWords } from './places.js';
import { CM_PER_M, DEG_PER_RAD, RPM_PER_RAD_S, format } from './units.js';
import { named, said, t } from './text.js';

/** @typedef {import('./types.js').ModeEntry} ModeEntry */
/** @typedef {import('./types.js').Scene} Scene */
/** @typedef {import('./types.js').State} State */
/** @typedef {import('./types.js').Cell} Cell */
/** @typedef {import('./store.js').Store} Store */
/** @typedef {import('./panel.js').Send} Send */

const SONARS = /** @type {const} */ (['left', 'right', 'front']);

export class StateLine {
  #state = element('state', HTMLOutputElement);
  #aim = element('aim', HTMLOutputElement);
  #end = element('end', HTMLOutputElement);
  #refusal = element('refusal', HTMLOutputElement);
  #fault = element('fault', HTMLDivElement);
  #faultText = element('fault-text', HTMLSpanElement);
  #pose = element('pose', HTMLOutputElement);
  #rig = element('rig-warning', HTMLDivElement);
  #rigText = element('rig-text', HTMLSpanElement);
  #tell = element('rig-tell', HTMLButtonElement);
  #store;
  /** @type {ModeEntry[]} */
  modes = [];
  /** Name of the simulated rig; null with a real robot. @type {string | null} */
  #carried = null;
  /** The sonars to show, by number. */
  sonars = [0, 1, 2];
  /** The names of those from 3 on. @type {string[]} */
  other_sonars = [];
  /** @type {State | null} */
  #slow = null;

  /** @param {Store} store @param {Send} send */
  constructor(store, send) {
    this.#store = store;
    element('clear-fault', HTMLButtonElement).addEventListener('click', () => send({ type: 'clear_fault' }));
    this.#tell.addEventListener('click', () => {
      if (this.#carried) send({ type: 'rig', rig: this.#carried });
    });
  }

  /** @param {Scene | null} scene */
  setScene(scene) {
    this.#carried = scene?.rig ?? null;
    this.#showRig();
  }

  /** @param {State} state */
  show(state) {
    this.#slow = state;
    this.#showRig();
    this.draw();
  }

  #showRig() {
    const believed = this.#slow?.robot.rig ?? null;
    const wrong = this.#carried !== null && believed !== null && believed !== this.#carried;
    this.#rig.hidden = !wrong;
    if (wrong) setText(this.#rigText, t('The robot is set to the sensor layout {}, but {} is mounted: it misreads its sonars.', believed ?? '', this.#carried ?? ''));
  }

  draw() {
    const slow = this.#slow;
    if (!slow) return;
    const { fault, task } = slow.robot;
    this.#fault.hidden = fault === null;
    this.#showFault(fault);
    const refused = slow.refused ?? '';
    this.#refusal.hidden = refused === '';
    setText(this.#refusal, said(refused));
    setText(this.#state, this.#stateWords(slow));
    const aim = this.#aimWords(slow);
    setText(this.#aim, aim);
    if (this.#aim.title !== aim) this.#aim.title = aim;
    const end = task.end;
    // What was reached before it was switched off is over.
    const shown = slow.robot.armed && (slow.replay || this.#store.playhead_s === Infinity) ? end : null;
    setText(this.#end, said(shown?.replace('_', ' ') ?? ''));
    this.#end.className = shown === null ? '' : `chip ${end === 'reached' ? 'good' : 'warning'}`;
    this.#showPose(slow);
  }

  /** Shows a fault, with the cause and the remedy below it. @param {string | null} fault */
  #showFault(fault) {
    const words = said(fault ?? '');
    if (words === this.#faultText.textContent) return;
    const [title = ''] = words.split(/(?<=: )/);
    this.#faultText.replaceChildren(create('b', { textContent: title }), words.slice(title.length));
  }

  /** @param {State} slow */
  #stateWords({ robot }) {
    const latest = this.#store.latest;
    const mode = this.modes.find((each) => each.id === robot.mode);
    if (robot.fault !== null) return t('fault');
    const looks_back = this.#store.playhead_s !== Infinity && latest !== null;
    if (looks_back && latest.mode >= 0) return latest.armed ? stateWords(this.modes.find((each) => each.id === latest.mode), latest.state) : t('off');
    if (!robot.armed) return t('off');
    const current = latest?.mode === robot.mode ? latest.state : 0;
    return stateWords(mode, current);
  }

  /** @param {State} slow */
  #aimWords(slow) {
    const { robot } = slow;
    const latest = this.#store.latest;
    const mode = this.modes.find((each) => each.id === robot.mode);
    const [left, right] = robot.reference;
    const answers = slow.link.connected || robot.text;
    if (slow.speed === 0 && !slow.replay) return t('time stands still: what is pressed happens when it runs again');
    const words = !answers || robot.armed || robot.fault !== null || slow.replay || slow.refused ? [] : [t('ON starts it')];
    const at = latest?.estimated;
    const to = latest?.heading_ref_rad ?? null;
    if (at && to !== null) {
      const [is, wanted] = [at.heading_rad, to].map((angle_rad) => wrapped(latest.origin.heading_rad + angle_rad) * DEG_PER_RAD);
      words.push(`${t('heading')} ${format(is, 0)}° → ${format(near(wanted ?? 0, is ?? 0), 0)}°`);
    };
    const kind = mode?.reference?.kind;
    if (kind === 'distance' && left !== 0) words.push(`${t('setpoint')} ${format(left * CM_PER_M)} cm`);
    if (kind === 'speed') words.push(`${t('setpoint')} ${format(left * RPM_PER_RAD_S, 0)} rpm`);
    if (kind === 'wheel_speed') words.push(`${t('setpoints')} ${format(left * RPM_PER_RAD_S, 0)} | ${format(right * RPM_PER_RAD_S, 0)} rpm`);
    const { goal, lane, route } = robot.task;
    if (lane) words.push(t('follows the lane'));
    if (route) words.push(t(route.repeat ? 'route of {}, again and again' : 'route of {}', route.waypoints.length));
    /** @type {[number, number] | null} */
    const target = goal ?? (route && robot.armed && robot.task.end === null ? [left, right] : null);
    if (target) {
      const away_m = at ? Math.hypot(target[0] - at.x_m, target[1] - at.y_m) : null;
      words.push(`${goal ? t('goal') : t('to')} ${inWords(target)} m${away_m === null ? '' : t(', {} m away', format(away_m, 2))}`);
    }
    return words.join(' · ');
  }

  /** @param {State} slow */
  #showPose({ robot }) {
    const latest = this.#store.latest;
    const at = latest?.estimated ? compose(latest.origin, latest.estimated) : latest?.truth;
    if (!latest || !at) return setText(this.#pose, '');
    const lines = [`x ${format(at.x_m, 3)} m   y ${format(at.y_m, 3)} m   ${t('heading')} ${degrees(at.heading_rad)}`];
    const ranges = this.sonars.map((id) => `${id < SONARS.length ? t(SONARS[id] ?? '') : this.other_sonars[id - SONARS.length]?.replaceAll('_', ' ')} ${inReach(latest.ranges_m[id] ?? null)}`);
    lines.push(`${robot.rig === null ? '' : `${named(robot.rig)}:  `}${ranges.join('   ')}`);
    if (latest.contact) lines.push(t('contact!'));
    return setText(this.#pose, lines.join('\n'));
  }
}

/** The name of a state. @param {ModeEntry | null | undefined} mode @param {number | null} state Null: the robot does not report it. */
export function stateWords(mode, state) {
  return state === null ? t('running') : said(mode?.states[state] ?? `state ${state}`);
}

/** @param {number} angle_rad */
function degrees(angle_rad) {
  return `${format(wrapped(angle_rad) * DEG_PER_RAD, 0)}°`;
}

/** @param {Cell} range_m */
function inReach(range_m) {
  return range_m === null ? t('no reading') : range_m === 'clear' ? t('clear|sonar') : `${format(range_m * CM_PER_M)} cm`;
}

/** For the map's corner: a place, and the same from the robot's origin where that is another frame. @param {ReturnType<import('./map.js').WorldMap['pointed']>} at */
export function pointerWords(at) {
  if (!at) return '';
  const [world, own] = [at.world, at.own].map((place) => place && `x ${format(place[0], 2)}  y ${format(place[1], 2)} m`);
  return own ? `${world}\n${t('from the robot\'s origin')} ${own}` : world ?? '';
}

