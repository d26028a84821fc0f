// @ts-check
/** Writing a program to an Arduino Mega from the site: Rumbo's own, where the site carries it, or another one. */
import { complaint, fileButton, wordsOf } from './dialog.js';
import { create, setText } from './dom.js';
import { choosePort, kindOf, nameOf, noOtherDrives, serial } from './serial_ports.js';
import { said, t } from './text.js';

/** A program to be written, and the port of the board. @typedef {{kind: string, name: string, file: string, content: Uint8Array}} Program */
/** How far that is: a phase and the part that is done, or why it has ended. @typedef {{phase: string, part: number} | {error: string}} Flashed */

/** The program that the site carries, and its SHA-256 in hexadecimal digits; the site's `index.html` says so. */
const OWN = 'rumbo.hex';
const SHA256 = document.querySelector('meta[name="rumbo-image"]')?.getAttribute('content') ?? null;
/** Largest file taken [bytes]. */
const LARGEST = 1_000_000;

/** The program of the site, checked by its hash. @returns {Promise<Uint8Array<ArrayBuffer>>} */
async function own() {
  const answer = await fetch(OWN);
  const content = new Uint8Array(await answer.arrayBuffer());
  const digest = new Uint8Array(await crypto.subtle.digest('SHA-256', content));
  const hex = [...digest].map((byte) => byte.toString(16).padStart(2, '0')).join('');
  if (!answer.ok || hex !== SHA256) throw new Error('the program of this site is damaged: load the page again');
  return content;
}

export class FlashForm {
  body = create('details', { id: 'flash' }, create('summary', { textContent: t('Write the program of an Arduino Mega') }));
  #ask;
  /** The file to be written; null: the site's own. @type {File | null} */
  #file = null;
  #name = create('b', { id: 'flash-file' });
  #write = create('button', { type: 'button', id: 'flash-write', className: 'go', textContent: t('Choose a port and write…') });
  #bar = create('progress', { id: 'flash-part', max: 1, hidden: true });
  #phase = create('output', { id: 'flash-phase' });
  #complaint = complaint();

  /** @param {(program: Program) => void} ask asks the worker */
  constructor(ask) {
    this.#ask = ask;
    this.#bar.setAttribute('aria-label', t('written'));
    const file = fileButton(t('Another program…'), '.hex,.elf', (file) => this.#take(file));
    this.#write.addEventListener('click', () => this.#begin());
    this.body.append(create('div', { className: 'stack' },
      create('p', { textContent: t('Over the USB cable, by the board\'s own boot loader. All of it is read back. If the cable comes off meanwhile, the board does nothing until it is written again. Parameters saved on the robot stay.') }),
      create('div', { className: 'row' }, this.#name, file), create('div', { className: 'row' }, this.#write, this.#bar, this.#phase), this.#complaint));
    this.#take(null);
  }

  /** Asks a person who closes the page in between. @param {BeforeUnloadEvent} event */
  static #askFirst(event) {
    event.preventDefault();
  }

  /** @param {File | null} file */
  #take(file) {
    this.#file = file;
    setText(this.#name, file?.name ?? (SHA256 === null ? t('no program chosen') : t('Rumbo\'s program')));
    this.#write.disabled = file === null && SHA256 === null;
    setText(this.#phase, '');
    setText(this.#complaint, '');
  }

  async #begin() {
    const ports = serial();
    if (!ports) return;
    setText(this.#complaint, '');
    setText(this.#phase, '');
    this.#write.disabled = true;
    try {
      const file = this.#file;
      if (file && file.size > LARGEST) throw new Error(t('{}: not sent, a program has at most {} MB', file.name, LARGEST / 1e6));
      await noOtherDrives();
      // First: browsers ask for a port only just after a click.
      const port = await choosePort(ports);
      const content = file ? new Uint8Array(await file.arrayBuffer()) : await own();
      this.#ask({ kind: kindOf(port), name: nameOf(port), file: file?.name ?? OWN, content });
    } catch (error) {
      this.show({ error: wordsOf(error) });
    }
  }

  /** @param {Flashed} flashed */
  show(flashed) {
    const writes = 'part' in flashed && flashed.phase !== 'done';
    this.#write.disabled = writes;
    this.#bar.hidden = !writes;
    if (writes) addEventListener('beforeunload', FlashForm.#askFirst);
    else removeEventListener('beforeunload', FlashForm.#askFirst);
    if ('error' in flashed) {
      setText(this.#phase, '');
      return setText(this.#complaint, said(flashed.error));
    }
    this.#bar.value = flashed.part;
    return setText(this.#phase, writes ? said(flashed.phase) : t('done: the robot starts again, disarmed'));
  }
}
