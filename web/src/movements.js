// @ts-check
/**
 * The basic movements of mode 0: buttons that act until the next one, and arrow keys or a gamepad, which drive while held.
 *
 * The command of a held key is repeated, and the station releases the wheels when it receives none: a page that hangs or is
 * gone also stops the robot. Releasing the key, another window, another field: the wheels are released.
 */
import { number, read, setLimits, write } from './decimal.js';
import { create, element } from './dom.js';
import { RPM_PER_RAD_S } from './units.js';
import { t } from './text.js';

/** @typedef {import('./panel.js').Send} Send */
/** @typedef {import('./steering.js').Stick} Stick */

/** The movements, by their numbers, as they lie around the robot. */
const MOVEMENTS = [
  { id: 9, sign: '↖', name: 'arc left' }, { id: 1, sign: '↑', name: 'forward' }, { id: 10, sign: '↗', name: 'arc right' },
  { id: 3, sign: '↺', name: 'turn left about the centre' }, { id: 0, sign: '■', name: 'release both wheels' }, { id: 4, sign: '↻', name: 'turn right about the centre' },
  { id: 11, sign: '↙', name: 'arc backward, centre on the left' }, { id: 2, sign: '↓', name: 'backward' }, { id: 12, sign: '↘', name: 'arc backward, centre on the right' },
  { id: 5, sign: `${t('L|wheel')} ↑`, name: 'pivot on the left wheel, forward' }, { id: 6, sign: `${t('L|wheel')} ↓`, name: 'pivot on the left wheel, backward' },
  { id: 7, sign: `${t('R|wheel')} ↑`, name: 'pivot on the right wheel, forward' }, { id: 8, sign: `${t('R|wheel')} ↓`, name: 'pivot on the right wheel, backward' },
];
const RELEASE = 0;
/** Forward and backward, left and right, to a movement. @type {Record<string, number>} */
const BY_KEYS = {
  '1,0': 1, '-1,0': 2, '0,1': 3, '0,-1': 4, '1,1': 9, '1,-1': 10, '-1,1': 11, '-1,-1': 12,
};
/** Period of a held key's command, a third of the station's time-out [ms]. */
const REPEAT_MS = 200;

export class Movements {
  #send;
  #root = element('movements', HTMLDivElement);
  #level = number('level', 35, 0, 100);
  #unit = create('select', { id: 'level-unit', title: t('Open loop by PWM, or closed loop by speed') },
    create('option', { value: 'duty', textContent: '% PWM' }), create('option', { value: 'speed', textContent: 'rpm' }));
  /** The movement that is held, and the part of the level; null: none. @type {{movement: number, depth: number} | null} */
  #held = null;

  /** @param {Send} send */
  constructor(send) {
    this.#send = send;
    this.#layOut();
    setInterval(() => {
      if (this.#held !== null) this.#order(this.#held.movement, true, this.#held.depth);
    }, REPEAT_MS);
  }

  /** @param {boolean} shown @param {boolean} armed */
  show(shown, armed) {
    this.#root.hidden = !shown;
    if (!shown || !armed) this.#held = null;
  }

  /** Follows keys or a gamepad. @param {Stick | null} stick */
  steer = (stick) => {
    const { forward, left, depth } = stick ?? { forward: 0, left: 0, depth: 1 };
    const movement = BY_KEYS[`${forward},${left}`];
    const wanted = movement === undefined ? null : { movement, depth };
    if (wanted?.movement === this.#held?.movement && wanted?.depth === this.#held?.depth) return;
    if (wanted !== null && !this.#level.reportValidity()) return;
    this.#held = wanted;
    this.#order(wanted?.movement ?? RELEASE, wanted !== null, depth);
  };

  /** @param {number} movement @param {boolean} held @param {number} [depth] the part of the level */
  #order(movement, held, depth = 1) {
    const level = read(this.#level) * depth;
    if (movement === RELEASE) this.#send({ type: 'move_duty', movement, duty: 0 });
    else if (this.#unit.value === 'duty') this.#send({ type: 'move_duty', movement, duty: level / 100, held });
    else this.#send({ type: 'move_speed', movement, speed_rad_s: level / RPM_PER_RAD_S, held });
  }

  #layOut() {
    this.#unit.addEventListener('change', () => {
      const duty = this.#unit.value === 'duty';
      setLimits(this.#level, 0, duty ? 100 : 190);
      write(this.#level, duty ? 35 : 60);
    });
    const pad = create('div', { className: 'pad' }, ...MOVEMENTS.map(({ id, sign, name }) => {
      const button = create('button', { type: 'button', title: t(name), textContent: sign, value: String(id) });
      button.setAttribute('aria-label', t(name));
      button.addEventListener('click', () => {
        if (this.#level.reportValidity()) this.#order(id, false);
      });
      return button;
    }), create('span', { className: 'hint', textContent: t('pivot on') }));
    const level = create('div', { className: 'row' }, create('label', {}, `${t('level')} `, this.#level), this.#unit);
    const hint = create('span', { className: 'hint', textContent: t('Armed, the arrow keys drive while they are held, or a gamepad with a shoulder button.') });
    this.#root.replaceChildren(pad, create('div', { className: 'stack' }, level, hint));
  }
}
