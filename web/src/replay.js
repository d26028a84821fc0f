// @ts-check
/** The bar of a replay: play, pause, step by telemetry frame, speed, and the position in the log. */
import { create, element, setText } from './dom.js';
import { format, formatShort } from './units.js';
import { t } from './text.js';
import { isSite } from './worker_link.js';

/** @typedef {import('./types.js').State} State */
/** @typedef {import('./panel.js').Send} Send */

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4, 8, 16];
/** Minimum time between two seeks while the pointer drags [ms]. */
const SCRUB_MS = 60;

export class ReplayBar {
  #bar = element('replay', HTMLDivElement);
  #play = element('replay-play', HTMLButtonElement);
  #scrub = element('replay-scrub', HTMLInputElement);
  #speed = element('replay-speed', HTMLSelectElement);
  #time = element('replay-time', HTMLOutputElement);
  #send;
  #playing = false;
  #dragging = false;
  #asked_ms = 0;

  /**
   * @param {Send} send
   * @param {() => void} resume shows the lab of the site again
   */
  constructor(send, resume) {
    this.#send = send;
    const back = element('replay-end', HTMLButtonElement);
    back.hidden = !isSite;
    back.addEventListener('click', resume);
    this.#speed.replaceChildren(...SPEEDS.map((factor) => create('option', { value: String(factor), textContent: `× ${formatShort(factor)}` })));
    this.#speed.value = '1';
    this.#play.addEventListener('click', () => this.toggle());
    this.#speed.addEventListener('change', () => {
      if (this.#playing) send({ type: 'speed', factor: Number(this.#speed.value) });
    });
    element('replay-back', HTMLButtonElement).addEventListener('click', () => this.step(-1));
    element('replay-on', HTMLButtonElement).addEventListener('click', () => this.step(1));
    this.#scrub.addEventListener('input', () => {
      this.#dragging = true;
      if (performance.now() - this.#asked_ms > SCRUB_MS) this.#seek();
    });
    this.#scrub.addEventListener('change', () => {
      this.#dragging = false;
      this.#seek();
    });
  }

  /** A log is shown. */
  get shown() {
    return !this.#bar.hidden;
  }

  /** Plays or pauses. */
  toggle() {
    this.play(!this.#playing);
  }

  /** @param {boolean} on */
  play(on) {
    this.#send({ type: 'speed', factor: on ? Number(this.#speed.value) : 0 });
  }

  /** @param {number} frames */
  step(frames) {
    this.#send({ type: 'step', frames });
  }

  /** @param {number} t_s */
  seek(t_s) {
    this.#send({ type: 'seek', t_s });
  }

  #seek() {
    this.#asked_ms = performance.now();
    this.seek(this.#scrub.valueAsNumber);
  }

  /** @param {State} state */
  show(state) {
    const { replay } = state;
    this.#bar.hidden = !replay;
    document.body.classList.toggle('replay', Boolean(replay));
    setText(element('live', HTMLButtonElement), replay ? t('Follow') : t('Live'));
    // Nothing is sent to a robot from a replay, nor from a viewer's page.
    const watching = document.body.classList.contains('viewer');
    element('command-section', HTMLElement).inert = element('parameter-section', HTMLElement).inert = Boolean(replay) || watching;
    this.#bar.inert = element('simulation', HTMLFormElement).inert = watching;
    if (!replay) return;
    this.#playing = state.speed > 0;
    setText(this.#play, this.#playing ? t('Pause') : t('Play'));
    if (this.#playing) this.#speed.value = String(state.speed);
    this.#scrub.max = String(replay.duration_s);
    if (!this.#dragging) this.#scrub.value = String(state.t_s);
    setText(this.#time, t('{} of {} s', format(state.t_s, 2), format(replay.duration_s, 2)));
    const name = element('replay-name', HTMLSpanElement);
    setText(name, replay.name);
    name.title = replay.name;
  }
}
