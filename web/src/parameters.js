// @ts-check
/** The parameter table: description, present value, and editing of each parameter. */
import { create, element, setText } from './dom.js';
import { said, t } from './text.js';
import { rangeWords, valueField, valueWords } from './value_field.js';

/** @typedef {import('./types.js').Parameter} Parameter */
/** @typedef {import('./panel.js').Send} Send */

/** One line of the table. */
class Line {
  /** @param {Parameter} parameter @param {Send} send @param {(line: Line) => void} explain shows what it is */
  constructor(parameter, send, explain) {
    this.parameter = parameter;
    this.edited = false;
    /** It was sent, and the robot's table does not show that yet. */
    this.sent = false;
    /** The refusal the operator has seen and left. @type {string | null} */
    this.dismissed = null;
    this.field = valueField(parameter);
    this.input = this.field.element;
    this.input.title = said(parameter.description);
    this.about = create('span', { id: `about-${parameter.name}`, textContent: said(parameter.description) });
    this.note = create('span', { className: 'refused', id: `note-${parameter.name}` });
    this.input.setAttribute('aria-describedby', `${this.about.id} why-${parameter.name}`);
    this.input.setAttribute('aria-label', t('{} in {}', parameter.name, parameter.unit || t('no unit')));
    this.apply = create('button', { type: 'button', textContent: t('Apply'), title: t('Write to the robot (Enter)') });
    this.revert = create('button', { type: 'button', textContent: '↺', title: t('Back to what the robot holds (Escape)') });
    this.revert.setAttribute('aria-label', t('Revert'));
    this.row = create('tr', {},
      create('td', { className: 'asks', textContent: parameter.name, title: said(parameter.description) }),
      create('td', {}, this.input),
      create('td', { textContent: unitWords(parameter.unit) }),
      create('td', { className: 'number', textContent: rangeWords(parameter) }),
      create('td', { className: 'number', textContent: valueWords(parameter, parameter.default) }),
      create('td', { className: 'acts' }, this.apply, this.revert, this.note),
    );
    this.why = create('tr', { className: 'why' }, create('td', { colSpan: 6, id: `why-${parameter.name}` }));
    const write = () => {
      const value = this.field.read();
      if (Number.isNaN(value)) return void (/** @type {HTMLInputElement} */ (this.input).reportValidity());
      // A value out of range is sent too: the robot refuses it with a reason.
      this.sent = true;
      this.dismissed = null;
      send({ type: 'set_param', id: this.parameter.id, value });
    };
    const revert = () => {
      this.edited = this.sent = false;
      this.dismissed = this.parameter.refused;
      this.show(this.parameter);
    };
    this.apply.addEventListener('click', write);
    this.revert.addEventListener('click', revert);
    this.input.addEventListener('input', () => {
      this.edited = true;
      this.show(this.parameter);
    });
    this.input.addEventListener('keydown', (event) => {
      // Enter ticks a switch.
      if (event.key === 'Enter' && this.parameter.type !== 'switch') write();
      if (event.key === 'Escape') revert();
    });
    // A tooltip is for a mouse; a finger taps the line, the keyboard comes to its value.
    this.input.addEventListener('focus', () => explain(this));
    this.row.addEventListener('click', () => explain(this));
    this.show(parameter);
  }

  /** @param {Parameter} parameter */
  show(parameter) {
    this.parameter = parameter;
    const held = this.field.text(parameter.value);
    const refused = parameter.refused === this.dismissed ? null : parameter.refused;
    this.field.limit(parameter);
    // A table that was on its way when it was sent does not overwrite it.
    if (this.sent && (parameter.pending || refused || this.field.text(this.field.read()) === held)) this.edited = this.sent = false;
    // What is being typed is not overwritten; a refused value stays to be corrected.
    if (!this.edited && !refused && !parameter.pending && this.field.held() !== held) this.field.hold(held);
    this.apply.hidden = this.revert.hidden = this.field.held() === held && !refused;
    const look = parameter.pending ? 'pending' : refused ? 'bad' : this.edited ? 'edited' : '';
    for (const each of ['pending', 'bad', 'edited']) this.row.classList.toggle(each, each === look);
    this.why.hidden = !refused || this.row.hidden;
    setText(/** @type {Element} */ (this.why.firstElementChild), refused ? t('refused: {}', said(refused)) : '');
    setText(this.note, parameter.pending ? t('waiting…') : refused ? '✗' : parameter.value === null ? t('not read yet') : '');
  }
}

export class ParameterTable {
  #body = element('parameters', HTMLTableSectionElement);
  #all = element('all-parameters', HTMLInputElement);
  #note = element('parameter-note', HTMLSpanElement);
  #save = element('save-parameters', HTMLButtonElement);
  #reset = element('reset-parameters', HTMLButtonElement);
  #table = element('parameter-section', HTMLElement);
  #about = element('parameter-about', HTMLParagraphElement);
  /** What every parameter is, for readers of the screen. */
  #abouts = element('parameter-abouts', HTMLDivElement);
  #send;
  /** @type {Map<number, Line>} */
  #lines = new Map();
  #mode = 0;
  /** @type {import('./types.js').ModeEntry[]} */
  #modes = [];
  /** Some value is known. */
  #known = false;
  /** Why there are no values, if there are none. */
  #why = '';

  /** @param {Send} send */
  constructor(send) {
    this.#send = send;
    this.#all.addEventListener('change', () => this.#filter());
    this.#save.addEventListener('click', () => send({ type: 'save_params' }));
    this.#reset.addEventListener('click', () => send({ type: 'reset_params' }));
  }

  /** @param {import('./types.js').ModeEntry[]} modes */
  setModes(modes) {
    this.#modes = modes;
    this.#filter();
  }

  /** @param {Parameter[]} parameters */
  show(parameters) {
    const same = parameters.length === this.#lines.size && parameters.every(({ id, name }) => this.#lines.get(id)?.parameter.name === name);
    if (!same) {
      this.#lines = new Map(parameters.map((parameter) => [parameter.id, new Line(parameter, this.#send, (line) => this.#explain(line))]));
      this.#abouts.replaceChildren(...[...this.#lines.values()].map(({ about }) => about));
      setText(this.#about, t('Tap a line, or go to its value, to read what it is.'));
      this.#filter();
    }
    for (const parameter of parameters) this.#lines.get(parameter.id)?.show(parameter);
    this.#known = parameters.some(({ value }) => value !== null);
    this.#tell();
  }

  /**
   * Shows the parameters of this mode and those of the robot.
   * @param {number} mode
   * @param {string} why there are no values, if there are none
   */
  setMode(mode, why) {
    this.#why = why;
    this.#tell();
    if (mode === this.#mode) return;
    this.#mode = mode;
    this.#filter();
  }

  /** Describes a parameter below the table, and marks its line. @param {Line} chosen */
  #explain(chosen) {
    for (const line of this.#lines.values()) line.row.classList.toggle('chosen', line === chosen);
    this.#about.replaceChildren(create('b', { textContent: chosen.parameter.name }), ` ${said(chosen.parameter.description)}`);
  }

  #tell() {
    const replay = document.body.classList.contains('replay');
    const why = replay && !this.#known ? t('the log does not contain the parameters') : this.#why;
    setText(this.#note, why);
    for (const button of [this.#save, this.#reset]) button.hidden = replay || why !== '';
    this.#table.classList.toggle('without', why !== '');
  }

  /** The mode's own parameters first, then those of the robot, then those of the other modes. */
  #filter() {
    const rest = new Map(this.#lines);
    /** Takes the lines of these parameters out of the rest. @param {number[]} ids */
    const lines = (ids) => ids.flatMap((id) => {
      const line = rest.get(id);
      return line && rest.delete(id) ? [line] : [];
    });
    const groups = (this.#modes.find(({ id }) => id === this.#mode)?.parameters ?? []).map(([title, ids]) => rows(said(title), lines(ids)));
    const robot = rows(t('the robot'), lines([...rest.values()].filter(({ parameter }) => parameter.of_robot).map(({ parameter }) => parameter.id)));
    const others = rows(t('other modes'), [...rest.values()], !this.#all.checked);
    this.#body.replaceChildren(...groups.flat(), ...robot, ...others);
  }
}

/** Lines below their title. @param {string} title @param {Line[]} lines @param {boolean} [hidden] */
function rows(title, lines, hidden = false) {
  if (lines.length === 0) return [];
  const made = [create('tr', { className: 'group' }, create('th', { colSpan: 6, textContent: title })), ...lines.map(({ row }) => row)];
  for (const row of made) row.hidden = hidden;
  for (const { row, why } of lines) made.splice(made.indexOf(row) + 1, 0, why);
  return made;
}

/** A unit as people write it. @param {string} unit */
export const unitWords = (unit) => unit.replace(/([a-z])2\b/g, '$1²');
