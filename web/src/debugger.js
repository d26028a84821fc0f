// @ts-check
/**
 * The debugger of the page: speaks the Debug Adapter Protocol with the lab's, and shows where the program stands, how it came
 * there, and what its variables are.
 */
import { clickable, create, element, setText } from './dom.js';
import { Requests } from './source.js';
import { said, t } from './text.js';
import { format } from './units.js';

/** @typedef {{id: number, name: string, line: number, source?: {name: string, path?: string}}} Frame */
/** @typedef {{name: string, value: string, type?: string, variablesReference: number}} Variable */
/** @typedef {import('./types.js').DebugMessage} DebugMessage */

/** The map is that of then, if it is so far back [us]. */
const SEEN_US = 20_000;
/** What is unfolded at first. */
const OPEN = ['Locals', 'Globals'];

export class Debugger {
  #requests;
  #editor;
  #lookAt;
  #panel = element('debug-panel', HTMLDivElement);
  #buttons = /** @type {NodeListOf<HTMLButtonElement>} */ (this.#panel.querySelectorAll('.row button'));
  #words = element('debug-words', HTMLOutputElement);
  #stack = element('debug-stack', HTMLOListElement);
  #scopes = element('debug-scopes', HTMLDivElement);
  /** @type {import('./types.js').HeldState | null} */
  #held = null;
  /** Paths of what is unfolded, and the values seen last. */
  #open = new Set(OPEN);
  /** @type {Map<string, string>} */
  #values = new Map();
  #frame = 0;
  #run = 0;
  /** A page that comes later begins where the program stands. */
  #begun = false;

  /**
   * @param {(order: import('./types.js').Order) => void} send
   * @param {() => import('./code_editor.js').CodeEditor | null} editor
   * @param {(t_s: number | null) => void} lookAt shows the map as it was then; null: as it is
   */
  constructor(send, editor, lookAt) {
    this.#requests = new Requests((request) => send({ type: 'debug', request }));
    this.#editor = editor;
    this.#lookAt = lookAt;
    for (const button of this.#buttons) button.addEventListener('click', () => this.act(button.value));
  }

  /** The program is in the debugger's hands. */
  get holds() {
    return this.#held !== null;
  }

  /** @param {string} command */
  act(command) {
    if (!this.#held) return;
    const order = command === 'continue' && !this.#held.stands ? 'pause' : command;
    this.#requests.ask(order, { threadId: 1 }).catch((error) => setText(this.#words, said(error.message)));
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    const command = { F8: 'continue', F10: 'next' }[event.key];
    if (!command || !this.#held) return;
    event.preventDefault();
    this.act(command);
  }

  /** The program has begun: breakpoints come first, and without any it stands at its first line. */
  async #begin() {
    this.#begun = true;
    const wanted = Object.values(this.#editor()?.breakpoints ?? {}).some((lines) => lines.length > 0);
    await this.sendBreakpoints();
    this.#goes = wanted;
    await this.#requests.ask('configurationDone');
  }

  /** Goes on from its first line. */
  #goes = false;

  /** Sends the breakpoints as they are, and moves those without code of their own to the line that has. */
  async sendBreakpoints() {
    const editor = this.#editor();
    if (!this.#held || !editor) return;
    const all = editor.breakpoints;
    let moved = false;
    for (const [name, lines] of Object.entries(all)) {
      const asked = { source: { path: name }, breakpoints: lines.map((line) => ({ line })) };
      const { breakpoints } = await this.#requests.ask('setBreakpoints', asked).catch(() => ({ breakpoints: [] }));
      const own = breakpoints.map((/** @type {any} */ each, /** @type {number} */ index) => each.line ?? lines[index]);
      moved ||= own.some((/** @type {number} */ line, /** @type {number} */ index) => line !== lines[index]);
      if (own.length === lines.length) all[name] = own;
    }
    if (moved) editor.breakpoints = all;
  }

  /** @param {DebugMessage[]} messages */
  receive(messages) {
    for (const message of messages) {
      if (message.type === 'response') this.#requests.receive(message);
      else if (message.event === 'stopped' && this.#goes) {
        this.#goes = false;
        this.act('continue');
      } else if (message.event === 'stopped') this.#refresh();
    }
  }

  /** @param {import('./types.js').State} state @param {number} run */
  show(state, run) {
    const held = state.program?.held ?? null;
    this.#panel.hidden = held === null;
    // Another program may follow at once.
    if (this.#held && run !== this.#run) this.#end();
    this.#run = run;
    if (held === null) {
      if (this.#held) this.#end();
      return;
    }
    const before = this.#held;
    this.#held = held;
    const past = held.stands && held.back_us > 0;
    const t_s = format(held.t_us / 1e6, 3);
    const words = !held.stands ? t('runs under the debugger') : past ? t('stands in the past, at {} s: the robot and its time with it', t_s) : t('stands at {} s: the robot and its time with it', t_s);
    if (before?.stands !== held.stands || before.t_us !== held.t_us) setText(this.#words, words);
    for (const button of this.#buttons) button.disabled = !held.stands && !['continue', 'disconnect'].includes(button.value);
    setText(element('debug-go', HTMLButtonElement), held.stands ? t('Continue') : t('Pause'));
    if (before?.stands !== held.stands || (held.stands && before.t_us !== held.t_us)) this.#lookAt(held.stands && held.back_us > SEEN_US ? held.t_us / 1e6 : null);
    if (!held.stands && before?.stands) this.#leave();
    if (before === null && !document.body.classList.contains('viewer')) {
      if (this.#begun || held.t_us > 0) this.#refresh();
      else this.#begin().catch((error) => setText(this.#words, said(error.message)));
    }
  }

  #end() {
    this.#held = null;
    this.#begun = false;
    this.#requests.forget();
    this.#values.clear();
    this.#lookAt(null);
    this.#leave();
  }

  /** It stands nowhere. */
  #leave() {
    this.#editor()?.standAt(null, 0);
    this.#stack.replaceChildren();
    this.#scopes.classList.add('old');
  }

  async #refresh() {
    try {
      const { stackFrames } = await this.#requests.ask('stackTrace', { threadId: 1, levels: 40 });
      await this.#choose(stackFrames, stackFrames.find((/** @type {Frame} */ { source }) => source?.path) ?? stackFrames[0]);
    } catch (error) {
      // It goes on already.
      if (error instanceof Error && error.message !== 'the program runs; pause it first') setText(this.#words, said(error.message));
    }
  }

  /** Shows a frame of the stack. @param {Frame[]} frames @param {Frame | undefined} frame */
  async #choose(frames, frame) {
    if (!frame) return;
    this.#frame = frame.id;
    this.#editor()?.standAt(frame.source?.path ?? null, frame.line);
    this.#stack.replaceChildren(...frames.map((each) => {
      const place = each.source ? `${each.source.name}:${each.line}` : '';
      const button = clickable({ className: 'link', disabled: !each.source?.path, textContent: each.name }, () => this.#choose(frames, each));
      const item = create('li', {}, button, create('span', { className: 'hint', textContent: ` ${place}` }));
      if (each === frame) item.setAttribute('aria-current', 'true');
      return item;
    }));
    const { scopes } = await this.#requests.ask('scopes', { frameId: frame.id });
    const made = await Promise.all(scopes.map((/** @type {Variable} */ scope) => this.#branch(scope.name, said(scope.name), '', scope.variablesReference)));
    this.#scopes.classList.remove('old');
    this.#scopes.replaceChildren(...made);
  }

  /** A part of the tree that unfolds. @param {string} path @param {string} name @param {string} value @param {number} reference */
  async #branch(path, name, value, reference) {
    const branch = create('details', { open: this.#open.has(path) }, create('summary', {}, create('b', { textContent: name }), value === '' ? '' : ' ', this.#value(path, value)));
    const fill = async () => {
      const { variables } = await this.#requests.ask('variables', { variablesReference: reference });
      const children = variables.map((/** @type {Variable} */ each) => this.#leaf(`${path}/${each.name}`, each));
      if (children.length === 0) children.push(create('p', { className: 'hint', textContent: t('none|variables') }));
      branch.append(...await Promise.all(children));
    };
    if (branch.open) await fill().catch(() => {});
    let filled = branch.open;
    branch.addEventListener('toggle', () => {
      if (branch.open) this.#open.add(path);
      else this.#open.delete(path);
      if (branch.open && !filled) fill().catch(() => {});
      filled ||= branch.open;
    });
    return branch;
  }

  /** @param {string} path @param {Variable} variable */
  #leaf(path, { name, value, variablesReference }) {
    if (variablesReference > 0) return this.#branch(path, name, value, variablesReference);
    return create('p', {}, create('b', { textContent: name }), ' ', this.#value(path, value));
  }

  /** A value, lit where it is another one than before. @param {string} path @param {string} value */
  #value(path, value) {
    const before = this.#values.get(path);
    this.#values.set(path, value);
    return create('output', { textContent: value, className: before !== undefined && before !== value ? 'changed' : '' });
  }

  /** An expression's value where the program stands. @param {string} expression @returns {Promise<string | null>} */
  async valueOf(expression) {
    if (!this.#held?.stands) return null;
    const asked = this.#requests.ask('evaluate', { expression, frameId: this.#frame, context: 'hover' });
    return asked.then(({ result }) => `${expression} = ${result}`, () => null);
  }
}
