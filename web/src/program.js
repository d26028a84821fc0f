// @ts-check
/** The student's own program: its name, whether it runs, and what the compiler rejects. */
import { create, element, setText } from './dom.js';
import { t } from './text.js';

/** @typedef {import('./types.js').State} State */

/** A program that does not speak Rumbo's protocol: it has no modes and no parameters for the page. @param {State} state */
export const isOwn = (state) => Boolean(state.simulated && state.robot.text);

/** What the program does, and how good that is. @param {State} state @returns {[string, 'good' | 'warning']} */
export function phaseWords({ program }) {
  if (program?.phase === 'compiling') return [t('compiling…'), 'warning'];
  return program?.phase === 'rejected' ? [t('does not compile'), 'warning'] : [t('program runs'), 'good'];
}

export class ProgramPanel {
  #panel = element('program', HTMLDivElement);
  #name = element('program-name', HTMLElement);
  #phase = element('program-phase', HTMLOutputElement);
  #hint = element('program-hint', HTMLParagraphElement);
  #list = element('complaints', HTMLOListElement);
  #shown = '';

  /** @param {State} state */
  show(state) {
    const { program } = state;
    this.#panel.hidden = !program;
    if (!program) return;
    setText(this.#name, program.name);
    const [words, level] = phaseWords(state);
    setText(this.#phase, words);
    this.#phase.className = `chip ${level}`;
    this.#hint.hidden = program.phase !== 'rejected';
    const complaints = program.complaints ?? [];
    const all = JSON.stringify(complaints);
    if (all === this.#shown) return;
    this.#shown = all;
    this.#list.hidden = complaints.length === 0;
    this.#list.replaceChildren(...complaints.map(({ place, text, line }) => create('li', {},
      create('b', { textContent: place ?? '' }), ` ${text}`, line === null ? '' : create('code', { textContent: line }))));
  }
}
