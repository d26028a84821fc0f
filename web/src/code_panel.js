// @ts-check
/**
 * The code pane: the source of the program that drives or of an example, its files as tabs, to change, run and debug. What is
 * typed stays in the browser's storage, by the sketch's name: the lab keeps it only as long as it runs.
 */
import { Debugger } from './debugger.js';
import { fileButton, saveFile } from './dialog.js';
import { clickable, create, element, setText } from './dom.js';
import { placeOf, plainName, sameFiles } from './source.js';
import { keep, recall } from './stored.js';
import { said, t } from './text.js';
import { isSite } from './worker_link.js';

/** @typedef {import('./types.js').SketchFile} SketchFile */
/** @typedef {import('./types.js').State} State */
/** @typedef {import('./code_editor.js').CodeEditor} CodeEditor */
/** `files`: null where they are those of the lab's. @typedef {{files: SketchFile[] | null, breakpoints: Record<string, number[]>}} Draft */

/** After so long without a key what is typed is stored [ms]. */
const STORE_MS = 300;

/** @param {string} name @returns {Draft | null} */
function stored(name) {
  try {
    return JSON.parse(recall(`sketch.${name}`) ?? 'null');
  } catch {
    return null;
  }
}

export class CodePanel {
  #section = element('code-section', HTMLElement);
  #toggle = element('code-open', HTMLButtonElement);
  #examples = element('code-examples', HTMLSelectElement);
  #tabs = element('code-tabs', HTMLDivElement);
  #note = element('code-note', HTMLOutputElement);
  #discard = element('code-discard', HTMLButtonElement);
  #complaints = element('complaints', HTMLOListElement);
  #send;
  /** @type {CodeEditor | null} */
  #editor = null;
  /** The sketch in the editor, and its files as the lab has them. */
  #name = '';
  /** @type {SketchFile[]} */
  #served = [];
  #ticket = 0;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  #timer;
  /** @type {State['program']} */
  #program;
  #shown = '';
  /** The place to go to when the files are there. @type {string | null} */
  #wanted = null;

  /**
   * @param {(order: import('./types.js').Order) => void} send
   * @param {(t_s: number | null) => void} lookAt
   */
  constructor(send, lookAt) {
    this.#send = send;
    this.debugger = new Debugger(send, () => this.#editor, lookAt);
    this.#toggle.hidden = isSite;
    this.#toggle.addEventListener('click', () => this.#open(this.#section.hidden));
    // On a telephone it is one of the parts.
    const part = document.querySelector('#views [value="code"]');
    if (isSite) part?.remove();
    part?.addEventListener('click', () => this.#open(true));
    this.#section.addEventListener('keydown', (event) => {
      if (event.key === 'Enter' && (event.ctrlKey || event.metaKey)) this.#run(false);
      else this.debugger.key(event);
    }, { capture: true });
    element('code-run', HTMLButtonElement).addEventListener('click', () => this.#run(false));
    element('code-debug', HTMLButtonElement).addEventListener('click', () => this.#run(true));
    element('code-save', HTMLButtonElement).addEventListener('click', () => {
      const file = this.#editor?.files.find(({ name }) => name === this.#editor?.name);
      if (file) saveFile(file.name.replace(/^.*\//, ''), new Blob([file.text], { type: 'text/plain' }));
    });
    const opens = fileButton(t('Open a sketch…'), '.ino,.h,.hpp,.c,.cpp,.S', (_, files) => this.#read(files), true);
    opens.title = t('Open the .ino of a sketch and the files beside it; an .ino that is dropped on the page runs at once');
    opens.querySelector('button')?.classList.add('small');
    this.#examples.after(opens);
    this.#discard.addEventListener('click', () => this.#take(this.#served, this.#editor?.breakpoints ?? {}));
    this.#examples.addEventListener('change', () => {
      this.#ask(this.#examples.value || undefined);
    });
    this.#complaints.addEventListener('click', ({ target }) => {
      if (target instanceof HTMLButtonElement) this.#goTo(target.value);
    });
  }

  /** @param {boolean} open */
  async #open(open) {
    if (open && !this.#editor) {
      const { CodeEditor } = await import('./code_editor.js');
      this.#editor ??= new CodeEditor(element('code-editor', HTMLDivElement), {
        changed: () => this.#changed(),
        breakpoints: () => {
          this.#store();
          this.debugger.sendBreakpoints();
        },
        valueOf: (expression) => this.debugger.valueOf(expression),
      });
      this.#ask();
    }
    this.#section.hidden = !open;
    // One list, where it is looked at.
    if (open) element('debug-panel', HTMLDivElement).before(this.#complaints);
    else element('program', HTMLDivElement).append(this.#complaints);
    this.#toggle.setAttribute('aria-pressed', String(open));
    document.body.classList.toggle('coding', open);
    if (open) this.#section.scrollIntoView({ block: 'nearest' });
  }

  /** Asks for the source of an example, or of what drives. @param {string} [example] */
  #ask(example) {
    this.#ticket = Math.floor(Math.random() * 2 ** 32);
    this.#send({ type: 'sketch', ticket: this.#ticket, ...(example ? { example } : {}) });
  }

  /** @param {import('./types.js').ShownSketch} sketch */
  receive(sketch) {
    if (sketch.ticket !== this.#ticket || !this.#editor) return;
    const first = create('option', { value: '', textContent: t('the sketch that drives') });
    this.#examples.replaceChildren(first, ...sketch.examples.map((name) => create('option', { value: name, textContent: t('example: {}', name) })));
    if (sketch.files.length === 0) {
      // Nothing to show of our own program or of an image: the first example is a beginning.
      if (sketch.examples.includes('wall')) this.#ask('wall');
      return;
    }
    this.#name = plainName(sketch.name);
    this.#served = sketch.files;
    this.#examples.value = sketch.examples.includes(sketch.name) && sketch.name !== this.#program?.name ? sketch.name : '';
    const draft = stored(sketch.name);
    this.#take(draft?.files ?? sketch.files, draft?.breakpoints ?? {});
    if (this.#program) this.#problems(this.#program);
    if (this.#wanted) this.#goTo(this.#wanted);
  }

  /** Shows a sketch of this computer. @param {File[]} files */
  async #read(files) {
    const read = await Promise.all(files.map(async (file) => ({ name: file.name, text: await file.text() })));
    const main = read.find(({ name }) => name.endsWith('.ino'));
    if (!main) return setText(this.#note, t('no .ino is among these files'));
    this.#name = plainName(main.name);
    main.name = `${this.#name}.ino`;
    this.#served = read;
    this.#take(read, {});
    this.#examples.value = '';
    setText(this.#note, t('{} is here: Run compiles it', main.name));
    return undefined;
  }

  /** @param {SketchFile[]} files @param {Record<string, number[]>} breakpoints */
  #take(files, breakpoints) {
    const main = `${this.#name}.ino`;
    const sorted = [...files].sort((one, other) => Number(other.name === main) - Number(one.name === main) || one.name.localeCompare(other.name));
    this.#editor?.setFiles(sorted);
    if (this.#editor) this.#editor.breakpoints = breakpoints;
    this.#tabs.replaceChildren(...sorted.map(({ name }) => clickable({ textContent: name, value: name }, () => this.#show(name))));
    this.#show(sorted[0]?.name ?? '');
    this.#say();
  }

  /** @param {string} name */
  #show(name) {
    this.#editor?.show(name);
    for (const tab of this.#tabs.querySelectorAll('button')) tab.setAttribute('aria-pressed', String(tab.value === name));
  }

  /** @param {string} text `wall.ino:3:7` */
  async #goTo(text) {
    const place = placeOf(text);
    if (!place) return;
    const begins = this.#editor === null;
    this.#wanted = begins ? text : null;
    await this.#open(true);
    if (begins) return;
    this.#show(place.file);
    this.#editor?.goTo(place.line, place.column ?? 1);
  }

  #changed() {
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.#store(), STORE_MS);
    this.#say();
  }

  /** Whether the lab has other files. */
  get #differs() {
    return this.#editor !== null && !sameFiles(this.#editor.files, this.#served);
  }

  #say() {
    this.#discard.hidden = !this.#differs;
    setText(this.#note, this.#differs ? t('changed; kept in this browser') : '');
  }

  #store() {
    if (!this.#editor || this.#name === '') return;
    const { files, breakpoints } = this.#editor;
    // What was handed in is nowhere else.
    const isOnlyHere = this.#differs || (this.#program?.name === this.#name && !this.#program.watched);
    const kept = keep(`sketch.${this.#name}`, JSON.stringify({ files: isOnlyHere ? files : null, breakpoints }));
    if (!kept) setText(this.#note, t('this browser stores nothing: save the file'));
  }

  /** @param {boolean} debug */
  #run(debug) {
    if (!this.#editor || this.#name === '') return;
    this.#store();
    this.#send({ type: 'program', name: this.#name, files: this.#editor.files, debug });
  }

  /** @param {State} state @param {number} run */
  show(state, run) {
    this.#program = state.program;
    this.debugger.show(state, run);
    if (!state.program || !this.#editor) return;
    const { name, phase, watched, complaints } = state.program;
    const shown = JSON.stringify([name, phase, complaints]);
    if (shown === this.#shown) return;
    this.#shown = shown;
    this.#problems(state.program);
    // Its file was saved, or another one dropped.
    if (phase !== 'compiling' && !this.#differs && (watched || plainName(name) !== this.#name)) this.#ask();
  }

  /** @param {NonNullable<State['program']>} program */
  #problems({ name, complaints }) {
    /** @type {Map<string, import('./code_editor.js').Problem[]>} */
    const problems = new Map();
    for (const { place, text } of (plainName(name) === this.#name && complaints) || []) {
      const at = placeOf(place);
      if (at) problems.set(at.file, [...problems.get(at.file) ?? [], { line: at.line, column: at.column, text: said(text) }]);
    }
    this.#editor?.setProblems(problems);
  }
}
