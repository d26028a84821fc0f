// @ts-check
/** The student's own program: its name, whether it runs, and what the compiler rejects. */
import { fileButton } from './dialog.js';
import { create, element, setText } from './dom.js';
import { said, t } from './text.js';
import { isSite } from './worker_link.js';

/** @typedef {import('./types.js').State} State */

/** A program that does not speak Rumbo's protocol: it has no modes and no parameters for the page. @param {State} state */
export const isOwn = (state) => Boolean(state.simulated && state.robot.text);

/** What the program does, and how good that is. @param {State} state @returns {[string, 'good' | 'warning']} */
export function phaseWords({ program }) {
  if (program?.phase === 'compiling') return [t('compiling…'), 'warning'];
  if (program?.held?.stands) return [t('stands: time stands still'), 'warning'];
  return program?.phase === 'rejected' ? [t('does not compile'), 'warning'] : [t('program runs'), 'good'];
}

/** Largest file taken [bytes]: an image for the Mega with what a debugger needs. */
const LARGEST = 1_000_000;

/** A file's content as the station takes it. @param {File} file @returns {Promise<string>} */
export function base64(file) {
  return new Promise((done, failed) => {
    const reader = new FileReader();
    reader.addEventListener('load', () => done(String(reader.result).replace(/^.*?,/, '')));
    reader.addEventListener('error', () => failed(reader.error));
    reader.readAsDataURL(file);
  });
}

export class ProgramPanel {
  #panel = element('program', HTMLDivElement);
  #name = element('program-name', HTMLElement);
  #phase = element('program-phase', HTMLOutputElement);
  #hint = element('program-hint', HTMLParagraphElement);
  #watched = element('program-watched', HTMLElement);
  #list = element('complaints', HTMLOListElement);
  #drop = element('program-drop', HTMLElement);
  #shown = '';

  /**
   * A sketch or an image that is dropped on the page runs, where there is an emulated Mega to run it. On the site a
   * recording that is dropped is shown, and a scenario begins.
   * @param {(order: import('./types.js').Order) => void} send
   * @param {(why: string) => void} complain
   * @param {(file: File) => void} showRecording
   * @param {(files: File[]) => void} openScenario
   */
  constructor(send, complain, showRecording, openScenario) {
    const carriesFile = (/** @type {DragEvent} */ event) => (isSite ? !document.body.classList.contains('at-port') : document.body.classList.contains('simulated')) && event.dataTransfer?.types.includes('Files');
    const run = async (/** @type {File} */ file) => {
      if (file.size > LARGEST) complain(t('{}: not sent, a program has at most {} MB', file.name, LARGEST / 1e6));
      else send({ type: 'program', name: file.name, data: await base64(file) });
    };
    addEventListener('dragover', (event) => {
      if (carriesFile(event)) event.preventDefault();
    });
    addEventListener('drop', async (event) => {
      const files = [...event.dataTransfer?.files ?? []];
      const [file] = files;
      if (!file || !carriesFile(event)) return;
      event.preventDefault();
      if (isSite && /\.mcap$/i.test(file.name)) showRecording(file);
      else if (isSite && /\.toml$/i.test(file.name)) openScenario(files);
      else await run(file);
    });
    if (!isSite) return;
    setText(this.#drop, t('.elf or .hex, or drop one here; an .ino needs rumbo on a computer'));
    // Fingers drop no files.
    const choose = fileButton(t('Run a program…'), '.elf,.hex', run);
    choose.title = t('Run a program for the Arduino Mega, .elf or .hex, on an emulated one');
    const opens = fileButton(t('Open a scenario…'), '.toml', (_, files) => openScenario(files), true);
    opens.title = t('Open the file of a scenario, and that of its world if it has one of its own');
    this.#drop.before(choose, opens);
  }

  /** @param {State} state */
  show(state) {
    const { program } = state;
    this.#panel.hidden = !program && !(isSite && state.simulated);
    this.#name.hidden = this.#phase.hidden = !program;
    this.#panel.classList.toggle('idle', !program);
    if (!program) return;
    setText(this.#name, program.name);
    const [words, level] = phaseWords(state);
    setText(this.#phase, words);
    this.#phase.className = `chip ${level}`;
    this.#watched.hidden = !program.watched;
    this.#hint.hidden = program.phase !== 'rejected';
    const complaints = program.complaints ?? [];
    const all = JSON.stringify(complaints);
    if (all === this.#shown) return;
    this.#shown = all;
    this.#list.hidden = complaints.length === 0;
    this.#list.replaceChildren(...complaints.map(({ place, text, line }) => create('li', {},
      place !== null && !isSite ? create('button', { type: 'button', className: 'link', value: place, textContent: place }) : create('b', { textContent: place ?? '' }), ` ${said(text)}`, line === null ? '' : create('code', { textContent: line }))));
  }
}
