// @ts-check
/** The command panel: mode, ON and OFF, the mode's reference, the basic movements. */
import { create, element, setText } from './dom.js';
import { CM_PER_M, RPM_PER_RAD_S, format } from './units.js';

/** @typedef {import('./types.js').ModeEntry} ModeEntry */
/** @typedef {import('./types.js').State} State */
/** @typedef {(order: import('./types.js').Order) => void} Send */

/** The movements, by their numbers, as they lie around the robot. */
const MOVEMENTS = [
  { id: 9, sign: '↖', name: 'arc left' }, { id: 1, sign: '↑', name: 'forward' }, { id: 10, sign: '↗', name: 'arc right' },
  { id: 3, sign: '↺', name: 'turn left about the centre' }, { id: 0, sign: '■', name: 'release both wheels' }, { id: 4, sign: '↻', name: 'turn right about the centre' },
  { id: 11, sign: '↙', name: 'arc backward, centre on the left' }, { id: 2, sign: '↓', name: 'backward' }, { id: 12, sign: '↘', name: 'arc backward, centre on the right' },
  { id: 5, sign: 'L ↑', name: 'pivot on the left wheel, forward' }, { id: 6, sign: 'L ↓', name: 'pivot on the left wheel, backward' },
  { id: 7, sign: 'R ↑', name: 'pivot on the right wheel, forward' }, { id: 8, sign: 'R ↓', name: 'pivot on the right wheel, backward' },
];

export class CommandPanel {
  #send;
  #modes = element('modes', HTMLDivElement);
  #reference = element('reference', HTMLFormElement);
  #movements = element('movements', HTMLDivElement);
  #armed = element('armed', HTMLOutputElement);
  #fault = element('fault', HTMLDivElement);
  #faultText = element('fault-text', HTMLSpanElement);
  /** @type {ModeEntry[]} */
  #entries = [];
  /** The mode the panel is laid out for. @type {number | null} */
  #shown = null;
  /** @type {HTMLOutputElement | null} */
  #inForce = null;

  /** @param {Send} send */
  constructor(send) {
    this.#send = send;
    element('stop', HTMLButtonElement).addEventListener('click', () => send({ type: 'stop' }));
    element('on', HTMLButtonElement).addEventListener('click', () => send({ type: 'arm' }));
    element('off', HTMLButtonElement).addEventListener('click', () => send({ type: 'disarm' }));
    element('clear-fault', HTMLButtonElement).addEventListener('click', () => send({ type: 'clear_fault' }));
    // Space stops, wherever the focus is: ahead of whatever else it would do there.
    for (const type of /** @type {const} */ (['keydown', 'keyup'])) {
      addEventListener(type, (event) => {
        if (event.code !== 'Space') return;
        event.preventDefault();
        event.stopPropagation();
        if (type === 'keydown' && !event.repeat) send({ type: 'stop' });
      }, { capture: true });
    }
    this.#layOutMovements();
  }

  /** @param {ModeEntry[]} modes */
  setModes(modes) {
    this.#entries = modes;
    this.#shown = null;
    this.#modes.replaceChildren(...modes.map((mode) => {
      const button = create('button', { type: 'button', value: String(mode.id) }, create('b', { textContent: String(mode.id) }), mode.name.replaceAll('_', ' '));
      button.addEventListener('click', () => this.#send({ type: 'mode', mode: mode.id }));
      return button;
    }));
  }

  /** @param {State} state */
  show(state) {
    const { mode, armed, fault } = state.robot;
    for (const button of this.#modes.querySelectorAll('button')) {
      button.setAttribute('aria-pressed', String(button.value === String(mode)));
      button.disabled = armed && button.value !== String(mode);
      button.title = button.disabled ? 'Switch OFF first' : '';
    }
    setText(this.#armed, fault ? 'fault' : armed ? 'armed' : 'off');
    this.#armed.className = `chip ${fault ? 'bad' : armed ? 'good' : ''}`;
    this.#fault.hidden = fault === null;
    setText(this.#faultText, fault ?? '');
    if (this.#shown !== mode) {
      this.#shown = mode;
      this.#layOut(this.#entries.find((entry) => entry.id === mode));
    }
    this.#showReference(state);
  }

  /** @param {State} state */
  #showReference(state) {
    if (!this.#inForce) return;
    const entry = this.#entries.find((each) => each.id === this.#shown);
    const [left, right] = state.robot.reference;
    if (entry?.reference?.kind === 'distance') setText(this.#inForce, `now ${format(left * CM_PER_M)} cm`);
    if (entry?.reference?.kind === 'wheel_speed') {
      setText(this.#inForce, `now ${format(left * RPM_PER_RAD_S, 0)} | ${format(right * RPM_PER_RAD_S, 0)} rpm`);
    }
  }

  /** @param {ModeEntry | undefined} mode */
  #layOut(mode) {
    this.#movements.hidden = !mode?.movements;
    this.#inForce = create('output', { className: 'hint' });
    const reference = mode?.reference;
    if (reference?.kind === 'distance') this.#layOutDistance(reference.min * CM_PER_M, reference.max * CM_PER_M);
    else if (reference?.kind === 'wheel_speed') this.#layOutSpeeds(reference.min * RPM_PER_RAD_S, reference.max * RPM_PER_RAD_S);
    else {
      this.#inForce = null;
      this.#reference.replaceChildren();
      this.#reference.onsubmit = (event) => event.preventDefault();
    }
  }

  /**
   * @param {number} min_cm
   * @param {number} max_cm
   */
  #layOutDistance(min_cm, max_cm) {
    const input = number('reference-cm', 30, min_cm, max_cm);
    this.#reference.replaceChildren(create('label', {}, 'reference ', input, ' cm'), submit('Set'), this.#inForce ?? '');
    this.#reference.onsubmit = (event) => {
      event.preventDefault();
      this.#send({ type: 'reference', value: input.valueAsNumber / CM_PER_M });
    };
  }

  /**
   * @param {number} min_rpm
   * @param {number} max_rpm
   */
  #layOutSpeeds(min_rpm, max_rpm) {
    const left = number('reference-left-rpm', 60, min_rpm, max_rpm);
    const right = number('reference-right-rpm', 60, min_rpm, max_rpm);
    const both = create('input', { type: 'checkbox', id: 'reference-both', checked: true });
    const tie = () => {
      right.disabled = both.checked;
      if (both.checked) right.value = left.value;
    };
    both.addEventListener('change', tie);
    left.addEventListener('input', tie);
    tie();
    this.#reference.replaceChildren(
      create('label', {}, 'left ', left), create('label', {}, 'right ', right), ' rpm',
      create('label', {}, both, ' both'), submit('Set'), this.#inForce ?? '',
    );
    this.#reference.onsubmit = (event) => {
      event.preventDefault();
      this.#send({ type: 'wheel_reference', left: left.valueAsNumber / RPM_PER_RAD_S, right: right.valueAsNumber / RPM_PER_RAD_S });
    };
  }

  #layOutMovements() {
    const level = number('level', 35, 0, 100);
    const unit = create('select', { id: 'level-unit', title: 'Open loop by PWM, or closed loop by speed' },
      create('option', { value: 'duty', textContent: '% PWM' }), create('option', { value: 'speed', textContent: 'rpm' }));
    unit.addEventListener('change', () => {
      const duty = unit.value === 'duty';
      level.max = duty ? '100' : '190';
      level.value = duty ? '35' : '60';
    });
    const pad = create('div', { className: 'pad' }, ...MOVEMENTS.map(({ id, sign, name }) => {
      const button = create('button', { type: 'button', title: name, textContent: sign, value: String(id) });
      button.setAttribute('aria-label', name);
      button.addEventListener('click', () => {
        if (!level.reportValidity()) return;
        if (unit.value === 'duty') this.#send({ type: 'move_duty', movement: id, duty: level.valueAsNumber / 100 });
        else this.#send({ type: 'move_speed', movement: id, speed_rad_s: level.valueAsNumber / RPM_PER_RAD_S });
      });
      return button;
    }), create('span', { className: 'hint', textContent: 'pivot on' }));
    this.#movements.replaceChildren(pad, create('label', {}, 'level ', level), unit);
  }
}

/**
 * @param {string} id
 * @param {number} value
 * @param {number} min
 * @param {number} max
 */
function number(id, value, min, max) {
  return create('input', { type: 'number', id, value: String(value), min: String(Math.ceil(min * 10) / 10), max: String(Math.floor(max * 10) / 10), step: 'any', required: true });
}

/** @param {string} text */
function submit(text) {
  return create('button', { type: 'submit', textContent: text });
}
