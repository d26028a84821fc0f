// @ts-check
/**
 * *Your robot*: board, driver and pins of a robot that stands on somebody's desk, typed or dragged onto the board, checked at
 * once by the station; it drives with the sketch that is chosen here, and its file can be kept for `--robot`.
 */
import { complaint, dialog, fileButton, saveFile, wordsOf } from './dialog.js';
import { clickable, create, setText } from './dom.js';
import { ask } from './key.js';
import { base64 } from './program.js';
import { plainName } from './source.js';
import { said, t } from './text.js';
import { OPTIONAL, addable, added, byPin, isSource, pinOf, request, rowsOf, sensorOf } from './wiring.js';
import { SaidForm } from './said_form.js';

/** @typedef {import('./wiring.js').Choices} Choices */
/** @typedef {import('./wiring.js').Row} Row */
/** @typedef {import('./wiring.js').Answer} Answer */
/** A program to drive it. @typedef {{name: string, data?: string, files?: {name: string, text: string}[]}} Program */

/** A change is checked when no other has followed for so long [ms]. */
const PAUSE_MS = 200;
const MOST_FILES = 100;
/** @type {Record<string, string>} */
const PLACES = { left: 'left|wiring', right: 'right|wiring', front: 'front|wiring', rear: 'rear|wiring', link: 'Bluetooth' };
/** @type {Record<string, string>} */
const PARTS = {
  enable: 'enable', forward: 'forward input', backward: 'backward input', encoder: 'encoder', encoder_b: 'encoder, output B', trigger: 'sonar, Trig', echo: 'sonar, Echo',
  battery: 'divider of the battery', sonar: 'sonar', other_sonar: 'sonar of another name', link: 'Bluetooth', encoders: 'encoders', encoders_b: 'encoders, output B', faults: 'faults of the driver', rx: 'the board receives', tx: 'the board sends', standby: 'standby', fault: 'fault, low', servo: 'servo', line: 'line sensor', obstacle: 'obstacle sensor', sharp: 'Sharp', light: 'light sensor', maxsonar: 'MaxSonar',
  button: 'button', switch: 'switch|part', potentiometer: 'potentiometer', led: 'LED', buzzer: 'buzzer', infrared: 'infrared receiver', mpu6050: 'MPU-6050', vl53l0x: 'VL53L0X, distance by light', qmc5883l: 'compass QMC5883L', hmc5883l: 'compass HMC5883L', ssd1306: 'display SSD1306', hd44780: 'display HD44780',
};

/** What a signal, a part or another owner of a pin is, for people. @param {string} signal */
function words(signal) {
  if (signal in PARTS) return t(PARTS[signal] ?? '');
  const [, side = '', input = ''] = signal.match(/^(left|right|front|rear|link)_(.+)$/) ?? signal.match(/^(.+)_(trigger|echo)$/) ?? [];
  if (input in PARTS) return `${side in PLACES ? t(PLACES[side] ?? '') : side}, ${t(PARTS[input] ?? '')}`;
  const [, kind = signal, number = ''] = signal.match(/^(.+?)_(\d+)$/) ?? [];
  return kind in PARTS ? `${t(PARTS[kind] ?? '')} ${number}`.trim() : signal;
}

export class WireDialog {
  #send;
  #dialog = dialog('wire-dialog', t('Your robot'));
  #like = create('select', { id: 'wire-like' });
  #name = create('input', { type: 'text', id: 'wire-name', value: 'my_car', maxLength: 40, autocomplete: 'off', spellcheck: false });
  #board = create('select', { id: 'wire-board' });
  #driver = create('select', { id: 'wire-driver' });
  #said = new SaidForm(() => this.#changed());
  #rows = create('div', { id: 'wire-rows' });
  #add = create('select', { id: 'wire-add' });
  #drawing = create('ol', { id: 'wire-pins' });
  #problem = complaint();
  #remarks = create('ul', { id: 'wire-remarks', className: 'hint' });
  #program = create('output', { id: 'wire-program' });
  #drive = create('button', { type: 'button', id: 'wire-drive', className: 'go', textContent: t('Drive it'), disabled: true });
  #save = create('button', { type: 'button', textContent: t('Save file'), disabled: true });
  #text = create('pre', { id: 'wire-text', className: 'scroll', tabIndex: 0 });
  /** @type {Choices | null} */
  #choices = null;
  /** @type {Row[]} */
  #wired = [];
  /** @type {Answer} */
  #answer = {};
  /** @type {Program | null} */
  #chosen = null;
  /** Orders that the session has taken. */
  #taken = 0;
  /** The same when a program was handed in that is not made yet. @type {number | null} */
  #begun = null;
  #asked = 0;
  #timer = 0;

  /** @param {(order: import('./types.js').Order) => void} send */
  constructor(send) {
    this.#send = send;
    this.#problem.id = 'wire-problem';
    const label = (/** @type {string} */ text, /** @type {HTMLElement} */ field) => create('label', {}, `${text} `, field);
    const folder = create('input', { type: 'file', hidden: true, webkitdirectory: true });
    const open = clickable({ textContent: t('Sketch folder…') }, () => folder.click());
    folder.addEventListener('change', () => this.#read([...folder.files ?? []]));
    this.#dialog.body.append(
      create('p', { className: 'hint', textContent: t('Say where its wires go, by number or as A0; or drag a name onto the board. Then choose the sketch that drives it.') }),
      create('div', { className: 'row' }, label(t('begin with'), this.#like), label(t('name'), this.#name), label(t('board'), this.#board), label(t('motor driver'), this.#driver)),
      this.#said.element,
      create('div', { id: 'wire-parts' }, create('div', { className: 'stack' }, this.#rows, label(t('add'), this.#add)), this.#drawing),
      this.#problem, this.#remarks,
      create('div', { className: 'row' }, open, fileButton(t('Files…'), '.ino,.cpp,.c,.h,.hpp,.S,.elf,.hex', (_, files) => this.#read(files), true), folder, this.#program, create('span', { className: 'spacer' }), this.#save, this.#drive),
      create('details', {}, create('summary', { textContent: t('The robot file') }), this.#text),
    );
    for (const field of [this.#like, this.#board, this.#driver]) field.addEventListener('change', () => this.#begin(field === this.#like));
    this.#name.addEventListener('input', () => this.#changed());
    this.#add.addEventListener('change', () => {
      const fresh = added(this.#add.value, this.#wired);
      this.#wired.push(...fresh);
      this.#show();
      const first = document.getElementById(`wire-${fresh[0]?.signal}`);
      first?.scrollIntoView({ block: 'nearest' });
      first?.focus();
      this.#changed();
    });
    this.#save.addEventListener('click', () => saveFile(`${plainName(this.#name.value)}.toml`, new Blob([this.#answer.toml ?? ''], { type: 'application/toml' })));
    this.#drive.addEventListener('click', () => {
      if (!this.#chosen) return;
      this.#begun = this.#taken;
      this.#send({ type: 'program', ...this.#chosen, robot: this.#answer.toml });
    });
  }

  /** It stays open until the program drives, and says why it does not. @param {import('./types.js').State} state @param {number} orders that the session has taken */
  show({ program }, orders) {
    this.#taken = orders;
    if (!program || this.#begun === null || orders === this.#begun) return;
    const { phase, complaints = [] } = program;
    setText(this.#problem, phase === 'compiling' ? t('compiling…') : complaints.map(({ place, text }) => `${place === null ? '' : `${place}: `}${said(text)}`).join('\n'));
    if (phase === 'compiling') return;
    this.#begun = null;
    if (phase === 'running') this.#dialog.dialog.close();
  }

  async open() {
    this.#dialog.open();
    if (this.#choices) return;
    try {
      this.#choices = JSON.parse(await ask('robot', 'POST', '{}')).choices;
    } catch (error) {
      return setText(this.#problem, wordsOf(error));
    }
    const option = (/** @type {{name: string, title: string}} */ { name, title }) => create('option', { value: name, textContent: title });
    const { known, boards, drivers } = this.#choices ?? { known: [], boards: [], drivers: [] };
    this.#like.replaceChildren(create('option', { value: '', textContent: t('my own wiring') }), ...known.map(option));
    this.#board.replaceChildren(...boards.map(option));
    this.#driver.replaceChildren(...drivers.map(({ name, title, jumpers }) => {
      const own = / /.test(title) ? said(title) : title;
      return option({ name, title: jumpers ? t('{}, enables on jumpers', own) : own });
    }));
    this.#said.offer(this.#choices?.asked ?? []);
    this.#board.value = 'uno';
    this.#begin(false);
  }

  get #driverNow() {
    return this.#choices?.drivers.find(({ name }) => name === this.#driver.value);
  }

  get #boardNow() {
    return this.#choices?.boards.find(({ name }) => name === this.#board.value);
  }

  /** Another driver has other inputs. @param {boolean} whole a known robot brings its own of all */
  #begin(whole) {
    const known = this.#choices?.known.find(({ name }) => name === this.#like.value);
    if (known && whole) {
      this.#board.value = known.board;
      this.#driver.value = known.driver;
      this.#name.value = known.name.replace(/^kit_/, 'my_');
      this.#wired = Object.entries(known.pins).map(([signal, pin]) => ({ signal, pin }));
    }
    for (const field of [this.#board, this.#driver]) field.disabled = known !== undefined;
    const driver = this.#driverNow;
    if (driver && !known) this.#wired = rowsOf(driver, this.#wired);
    this.#show();
    this.#changed();
  }

  #show() {
    if (!this.#choices) return;
    const pins = create('datalist', { id: 'wire-names' }, ...(this.#boardNow?.pins ?? []).map(({ name }) => create('option', { value: name })));
    this.#rows.replaceChildren(pins, ...this.#wired.map((row) => this.#row(row)));
    const isKnown = this.#like.value !== '';
    const can = addable(this.#wired, this.#choices).filter((what) => !isKnown || OPTIONAL.has(what));
    this.#add.replaceChildren(create('option', { value: '', textContent: '…', disabled: true, selected: true }), ...can.map((what) => create('option', { value: what, textContent: words(what) })));
  }

  /** @param {Row} row */
  #row(row) {
    const id = `wire-${row.signal}`;
    const input = create('input', { type: 'text', id, value: row.pin, size: 5, maxLength: 20, autocomplete: 'off' });
    if (!row.kind) input.setAttribute('list', 'wire-names');
    input.addEventListener('input', () => {
      row.pin = input.value;
      this.#changed();
    });
    const label = create('label', { htmlFor: id, textContent: words(row.signal), draggable: true });
    label.addEventListener('dragstart', ({ dataTransfer }) => dataTransfer?.setData('text/plain', row.signal));
    const needed = this.#driverNow?.needed.includes(row.signal);
    const remove = create('button', { type: 'button', className: 'small', textContent: '×', title: t('Remove'), hidden: needed });
    remove.setAttribute('aria-label', t('Remove {}', words(row.signal)));
    remove.addEventListener('click', () => {
      this.#wired = this.#wired.filter((other) => other !== row);
      this.#show();
      this.#changed();
    });
    return create('div', {}, label, input, remove, ...this.#place(row));
  }

  /** Where a sensor is, which has a usual place. @param {Row} row */
  #place(row) {
    const sensor = sensorOf(row);
    if (sensor === null || this.#like.value !== '') return [];
    const field = create('input', { type: 'text', value: row.place ?? '', size: 12, maxLength: 30, autocomplete: 'off', placeholder: this.#answer.places?.[sensor] ?? '' });
    field.dataset['sensor'] = sensor;
    field.title = t('Ahead of the wheels\' axis and to the left in m, and where it looks in degrees, positive to the left');
    field.addEventListener('input', () => {
      row.place = field.value;
      this.#changed();
    });
    return [create('label', { className: 'wire-place' }, `${t('at x:y:angle')} `, field)];
  }

  #draw() {
    const board = this.#boardNow;
    if (!board) return;
    const on = byPin(board, this.#wired, this.#answer.on);
    this.#drawing.replaceChildren(...board.pins.map(({ name, pwm }) => {
      const owners = on.get(name) ?? [];
      const cell = create('li', { className: owners.length > 0 ? 'taken' : '' }, create('b', { textContent: pwm ? `~${name}` : name }), create('span', { textContent: owners.map(words).join(', ') }));
      cell.addEventListener('dragover', (event) => event.preventDefault());
      cell.addEventListener('drop', (event) => {
        const row = this.#wired.find(({ signal }) => signal === event.dataTransfer?.getData('text/plain'));
        if (!row) return;
        event.preventDefault();
        row.pin = name;
        this.#show();
        this.#changed();
      });
      return cell;
    }));
    this.#drawing.setAttribute('aria-label', t('Pins of the {}; ~ has PWM', board.title));
  }

  #changed() {
    this.#draw();
    this.#drive.disabled = this.#save.disabled = true;
    clearTimeout(this.#timer);
    this.#timer = window.setTimeout(() => this.#check(), PAUSE_MS);
  }

  async #check() {
    const [board, driver] = [this.#boardNow, this.#driverNow];
    if (!board || !driver) return;
    const asked = ++this.#asked;
    const open = this.#wired.filter(({ signal, pin }) => driver.needed.includes(signal) && pin.trim() === '').map(({ signal }) => words(signal));
    const about = { name: this.#name.value, like: this.#like.value || null, board: board.name, driver: driver.name, said: this.#said.said };
    const wrong = this.#wired.find(({ pin, kind }) => !kind && pin.trim() !== '' && !/^m\d$/i.test(pin.trim()) && pinOf(board, pin) === null);
    const local = open.length > 0 ? t('still without a pin: {}', open.join('; ')) : wrong ? t('{}: the {} has no pin {}', words(wrong.signal), board.title, wrong.pin) : null;
    /** @type {Answer} */
    let answer = {};
    try {
      answer = JSON.parse(await ask('robot', 'POST', JSON.stringify(request(about, this.#wired))));
    } catch (error) {
      answer = { problem: wordsOf(error) };
    }
    if (asked !== this.#asked) return;
    if (local !== null) delete answer.toml;
    this.#answer = answer;
    // What is refused as a whole leaves the fields as they were, to be mended.
    if (answer.asked || about.like !== null) this.#said.show(answer.asked ?? {});
    for (const field of this.#rows.querySelectorAll('input')) {
      const { sensor } = field.dataset;
      if (sensor) field.placeholder = answer.places?.[sensor] ?? '';
    }
    const { problem, remarks = [], alike, toml } = answer;
    setText(this.#problem, local ?? said(problem ?? ''));
    // Nothing is wrong yet.
    this.#problem.classList.toggle('complaint', open.length === 0);
    const like = alike && [t('{} of {} pins are those of {}', alike.same, alike.of, alike.robot), ...alike.others.map(([signal, pin]) => t('{} is {} there', words(signal), pin))].join('; ');
    this.#remarks.replaceChildren(...[...remarks.map(said), ...(like && about.like === null ? [like] : [])].map((textContent) => create('li', { textContent })));
    this.#text.textContent = toml ?? '';
    this.#draw();
    this.#ready();
  }

  #ready() {
    this.#save.disabled = !this.#answer.toml;
    this.#drive.disabled = !this.#answer.toml || !this.#chosen;
    this.#drive.title = this.#chosen ? '' : t('Choose its sketch first');
  }

  /** @param {File[]} files of a folder, or chosen one by one */
  async #read(files) {
    this.#chosen = null;
    const [first] = files;
    if (!first) return;
    const path = (/** @type {File} */ { webkitRelativePath, name }) => webkitRelativePath.replace(/^[^/]*\//, '') || name;
    if (/\.(elf|hex)$/i.test(first.name)) {
      this.#chosen = { name: plainName(first.name), data: await base64(first) };
    } else {
      const sources = files.filter((file) => isSource(path(file)));
      const main = sources.find(({ name }) => /\.(ino|pde)$/i.test(name));
      const folder = first.webkitRelativePath.match(/^[^/]+/)?.[0];
      if (sources.length === 0) setText(this.#problem, t('no sketch there: a folder with an .ino'));
      else if (sources.length > MOST_FILES) setText(this.#problem, t('{} files: a sketch has at most {}; choose its own folder', sources.length, MOST_FILES));
      else this.#chosen = { name: plainName(folder ?? main?.name ?? first.name), files: await Promise.all(sources.map(async (file) => ({ name: path(file), text: await file.text() }))) };
    }
    setText(this.#program, this.#chosen?.name ?? '');
    this.#ready();
  }
}
