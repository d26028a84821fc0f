// @ts-check
/**
 * The velocity of mode 10: a pad to drag on, arrow keys or a gamepad, which drive while held.
 *
 * The velocity is repeated, and the robot releases the wheels half a second after the last one: a page that hangs or is gone also
 * stops it.
 */
import { number, read } from './decimal.js';
import { create, element, setText } from './dom.js';
import { format } from './units.js';
import { t } from './text.js';

/** @typedef {import('./panel.js').Send} Send */
/** @typedef {import('./steering.js').Stick} Stick */

/** Period of a held velocity [ms]. */
const REPEAT_MS = 50;

export class Joystick {
  #send;
  #root = element('joystick', HTMLDivElement);
  #forward = number('top-forward', 0.3, 0, 1);
  #yaw = number('top-yaw', 2, 0, 10);
  #pad = create('div', { className: 'joystick', title: t('Drag: up is forward, left is a turn to the left') });
  #knob = create('i');
  #velocity = create('output', { className: 'hint' });
  /** Shares of the largest velocity; null: nobody holds it. @type {{ahead: number, aside: number} | null} */
  #held = null;
  #live = false;

  /** @param {Send} send */
  constructor(send) {
    this.#send = send;
    this.#layOut();
    setInterval(() => {
      if (this.#held) this.#order(this.#held);
    }, REPEAT_MS);
  }

  /** @param {boolean} shown @param {boolean} armed */
  show(shown, armed) {
    this.#root.hidden = !shown;
    this.#live = shown && armed;
    this.#pad.classList.toggle('live', this.#live);
    if (!this.#live && this.#held) this.#hold(null);
  }

  /** Follows keys or a gamepad. @param {Stick | null} stick */
  steer = (stick) => this.#hold(stick && { ahead: stick.ahead, aside: stick.aside });

  /** @param {{ahead: number, aside: number} | null} held */
  #hold(held) {
    const was = this.#held;
    const may = this.#live && this.#forward.checkValidity() && this.#yaw.checkValidity();
    this.#held = may ? held : null;
    const { ahead, aside } = this.#held ?? { ahead: 0, aside: 0 };
    this.#knob.style.translate = `${-aside * 40}px ${-ahead * 40}px`;
    // The wheels stand at once, not after half a second.
    if (this.#held || was) this.#order({ ahead, aside });
  }

  /** @param {{ahead: number, aside: number}} share */
  #order({ ahead, aside }) {
    const [forward_m_s, yaw_rad_s] = [ahead * read(this.#forward), aside * read(this.#yaw)];
    setText(this.#velocity, `${format(forward_m_s, 2)} m/s, ${format(yaw_rad_s, 2)} rad/s`);
    this.#send({ type: 'velocity', forward_m_s, yaw_rad_s });
  }

  /** Where a pointer is on the pad, within its circle. @param {PointerEvent} event */
  #at(event) {
    const { left, top, width, height } = this.#pad.getBoundingClientRect();
    const [aside, ahead] = [1 - 2 * (event.clientX - left) / width, 1 - 2 * (event.clientY - top) / height];
    const beyond = Math.max(1, Math.hypot(ahead, aside));
    return { ahead: ahead / beyond, aside: aside / beyond };
  }

  #layOut() {
    const pad = this.#pad;
    pad.append(this.#knob);
    pad.addEventListener('pointerdown', (event) => {
      if (!this.#live) return;
      pad.setPointerCapture(event.pointerId);
      this.#hold(this.#at(event));
    });
    pad.addEventListener('pointermove', (event) => {
      if (pad.hasPointerCapture(event.pointerId)) this.#hold(this.#at(event));
    });
    for (const type of /** @type {const} */ (['pointerup', 'pointercancel', 'lostpointercapture'])) pad.addEventListener(type, () => this.#hold(null));
    const limits = create('div', { className: 'row' },
      create('label', {}, `${t('at most')} `, this.#forward, ' m/s'), create('label', {}, this.#yaw, ' rad/s'));
    const hint = create('span', { className: 'hint', textContent: t('Armed, drag on the pad; or the arrow keys, or a gamepad with a shoulder button.') });
    this.#root.replaceChildren(pad, create('div', { className: 'stack' }, limits, this.#velocity, hint));
  }
}
