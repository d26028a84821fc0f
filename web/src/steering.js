// @ts-check
/**
 * Arrow keys or a gamepad, which steer while they are held. Releasing them, another window, another field: nothing is held.
 */
import { watchGamepads } from './gamepad.js';

/** @typedef {import('./gamepad.js').Stick} Stick */
/** @typedef {(stick: Stick | null) => void} Steer Null: nothing is held any more. */

export class Steering {
  /** @type {Set<string>} */
  #keys = new Set();
  /** What a gamepad holds. @type {Stick | null} */
  #stick = null;
  /** Who is steered; null: nobody. @type {Steer | null} */
  #steer = null;

  /** @param {() => void} onStop The gamepad's STOP, whichever robot is steered. */
  constructor(onStop) {
    addEventListener('keydown', (event) => this.#press(event), { capture: true });
    addEventListener('keyup', (event) => {
      if (this.#keys.delete(event.key)) this.#follow();
    }, { capture: true });
    addEventListener('blur', () => this.#letGo());
    document.addEventListener('visibilitychange', () => this.#letGo());
    document.addEventListener('focusin', (event) => {
      if (isField(event.target)) this.#letGo();
    });
    watchGamepads((stick) => this.#hold(stick), onStop);
  }

  /** Another one is steered from now on, or nobody; what is held ends. @param {Steer | null} steer */
  give(steer) {
    if (steer === this.#steer) return;
    this.#letGo();
    this.#steer = steer;
  }

  /** @param {Stick | null} stick */
  #hold(stick) {
    if (!this.#steer || (stick === null && this.#stick === null)) return;
    this.#stick = stick;
    this.#follow();
  }

  /** @param {KeyboardEvent} event */
  #press(event) {
    if (!this.#steer || !event.key.startsWith('Arrow') || event.ctrlKey || event.metaKey || event.altKey || isField(event.target)) return;
    event.preventDefault();
    event.stopPropagation();
    if (event.repeat) return;
    this.#keys.add(event.key);
    this.#follow();
  }

  #letGo() {
    if (this.#keys.size === 0 && this.#stick === null) return;
    this.#keys.clear();
    this.#stick = null;
    this.#follow();
  }

  /** By the keys, or the gamepad. */
  #follow() {
    const down = (/** @type {string} */ key) => Number(this.#keys.has(key));
    const [forward, left] = [down('ArrowUp') - down('ArrowDown'), down('ArrowLeft') - down('ArrowRight')];
    this.#steer?.(this.#keys.size > 0 ? { forward, left, depth: 1, ahead: forward, aside: left } : this.#stick);
  }
}

/** @param {EventTarget | null} target */
function isField(target) {
  return target instanceof HTMLInputElement || target instanceof HTMLSelectElement || target instanceof HTMLTextAreaElement;
}
