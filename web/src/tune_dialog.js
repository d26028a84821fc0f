// @ts-check
/**
 * *Tune*: values of parameters for an aim, searched on many simulated robots and checked on others, by the station beside its
 * session (`tune_search.js`). On the site, whose page has no threads for it, the dialog says which command does it.
 */
import { complaint, dialog, saveFile, wordsOf } from './dialog.js';
import { clickable, create, element, setText } from './dom.js';
import { ask } from './key.js';
import { grouped } from './header.js';
import { unitWords } from './parameters.js';
import { said, t } from './text.js';
import { format, formatFloat } from './units.js';
import { Search } from './tune_search.js';
import { certainlyWorse, resultTables } from './tune_tables.js';
import { isSite } from './worker_link.js';

/** @typedef {import('./panel.js').Send} Send */
/** @typedef {import('./types.js').Parameter} Parameter */
/** @typedef {import('./tune_search.js').Found} Found */
/** @typedef {import('./runs.js').Seeded} Seeded */

/**
 * A scenario that can be tuned: its limits, the runs of a search by default, and the parameters of its mode.
 * @typedef {object} Offer
 * @property {string} name
 * @property {string} title
 * @property {number} runs
 * @property {Record<string, {min: number | null, max: number | null}>} limits
 * @property {{title: string, parameters: {name: string, now: number}[]}[]} groups Those that matter most first.
 */

/** Of the first group so many are ticked: a search over more takes longer to find as much. */
const TICKED = 3;
const MOST_SEED = Number.MAX_SAFE_INTEGER;

export class TuneDialog {
  #send;
  #dialog = dialog('tune-dialog', t('Tune'));
  #scenario = create('select', { id: 'tune-scenario', disabled: true });
  #limits = create('p', { id: 'tune-limits', className: 'hint scroll' });
  #parameters = create('fieldset', { id: 'tune-parameters' });
  #aims = create('input', { type: 'text', id: 'tune-aims', placeholder: 'settling_s, overshoot_m < 0.01', maxLength: 500, autocomplete: 'off', spellcheck: false });
  #runs = create('input', { type: 'number', id: 'tune-runs', required: true, step: '1' });
  #seed = create('input', { type: 'number', id: 'tune-seed', min: '0', max: String(MOST_SEED), step: '1', value: '1', required: true });
  #start = create('button', { type: 'submit', id: 'tune-start', className: 'go', textContent: t('Start|tune'), disabled: true });
  #cancel = create('button', { type: 'button', id: 'tune-cancel', textContent: t('Cancel'), hidden: true });
  #part = create('progress', { id: 'tune-part', max: 1, hidden: true });
  #left = create('output', { id: 'tune-left', className: 'hint' });
  #complaint = complaint();
  #result = create('div', { id: 'tune-result', className: 'stack', hidden: true });
  #set = create('button', { type: 'button', id: 'tune-set', className: 'go', textContent: t('Set on the robot') });
  #curves = create('button', { type: 'button', id: 'tune-curves', textContent: t('Curves before and after') });
  /** @type {Offer[]} */
  #offers = [];
  /** By the names of their parameters: the value of the robot's file, and that to search from. @type {Map<string, {box: HTMLInputElement, value: HTMLElement, now: number, from: number}>} */
  #boxes = new Map();
  /** The robot's, by their names. @type {Map<string, Parameter>} */
  #table = new Map();
  /** Parameters that were set last: the refusals among them are shown. @type {Set<string>} */
  #sent = new Set();
  /** @type {import('./types.js').Scene | null} */
  #scene = null;
  /** @type {Search | null} */
  #search = null;
  #least = create('span', { className: 'hint' });
  /** The scenario that was loaded when the dialog was opened last. */
  #loaded = '';
  #page = 0;
  /** Shows runs side by side. @type {(runs: (Seeded & {name: string, about: {}, parameters: Record<string, number>, metrics: {}})[]) => void} */
  compare = () => {};
  #drives = false;

  /** @param {Send} send */
  constructor(send) {
    this.#send = send;
    element('tune', HTMLButtonElement).addEventListener('click', () => this.#open());
    const what = create('p', { textContent: t('Searches for values of parameters on many simulated robots that differ as real ones do, then drives 100 others with the values before and after.') });
    if (isSite) {
      this.#dialog.body.append(what, create('p', { textContent: t('It takes more than a page has: Rumbo on a computer does it.') }), create('pre', {}, this.#command));
      return;
    }
    what.append(` ${t('The robot of this page goes on meanwhile.')}`);
    this.#part.setAttribute('aria-label', t('Tune'));
    this.#scenario.addEventListener('change', () => this.#choose());
    this.#cancel.addEventListener('click', () => this.#end());
    this.#set.addEventListener('click', () => this.#setOnRobot());
    this.#curves.addEventListener('click', () => this.#showCurves());
    const form = create('form', { className: 'stack' },
      create('label', { className: 'wide' }, `${t('scenario')} `, this.#scenario), this.#limits, this.#parameters,
      create('label', { className: 'wide' }, `${t('aims')} `, this.#aims),
      create('p', { className: 'hint', textContent: t('Metrics to make small, and limits, with commas between them. Without any, all limits of the scenario are kept with as much room as possible.') }),
      create('div', { className: 'row' }, create('label', {}, `${t('runs')} `, this.#runs), this.#least, create('label', {}, `${t('seed')} `, this.#seed), this.#start, this.#cancel, this.#part, this.#left));
    form.addEventListener('submit', (event) => {
      event.preventDefault();
      this.#begin();
    });
    this.#dialog.body.append(what, form, this.#complaint, this.#result);
  }

  /** What does the same on a computer. */
  #command = create('code');
  /** @type {import('./types.js').ModeEntry[]} */
  modes = [];

  /** The parameters that matter most in a scenario. @param {string} scenario */
  #first(scenario) {
    const mode = this.#scene?.experiments.find(({ name }) => name === scenario)?.mode;
    const ids = this.modes.find(({ id }) => id === mode)?.parameters[0]?.[1] ?? [];
    return [...this.#table.values()].filter(({ id, type }) => type === 'number' && ids.includes(id)).slice(0, TICKED).map(({ name }) => name);
  }

  /** @param {import('./types.js').Scene | null} scene */
  setScene(scene) {
    this.#scene = scene;
  }

  /** @param {Parameter[]} parameters */
  setParameters(parameters) {
    this.#table = new Map(parameters.map((each) => [each.name, each]));
    // A robot that has just started tells its values one by one.
    if (!this.#search) this.#showValues();
    for (const name of this.#sent) {
      const refused = this.#table.get(name)?.refused;
      if (refused) setText(this.#complaint, `${name}: ${t('refused: {}', said(refused))}`);
    }
  }

  /** @param {{seat: import('./types.js').Seat, page: number}} control */
  setControl({ seat, page }) {
    this.#page = page;
    this.#drives = seat === 'driver' || seat === 'free';
    this.#allow();
  }

  /** Only a page with control sets something on the robot. */
  #allow() {
    for (const button of [this.#set, this.#curves]) {
      button.disabled = !this.#drives;
      button.title = this.#drives ? '' : t('another page has control; take it first');
    }
  }

  async #open() {
    this.#dialog.open();
    const loaded = this.#scene?.choice.scenario ?? 'mode1';
    if (isSite) return setText(this.#command, `rumbo tune ${loaded} --over ${this.#first(loaded).join(',')}`);
    if (this.#search) return undefined;
    setText(this.#complaint, '');
    if (this.#offers.length === 0) setText(this.#limits, t('loading…'));
    try {
      const { least_runs, most_runs, scenarios } = JSON.parse(await ask('/tune'));
      this.#offers = scenarios;
      Object.assign(this.#runs, { min: String(least_runs), max: String(most_runs), title: t('{} to {} {}', least_runs, most_runs, t('runs')) });
      setText(this.#least, t('at least {}', least_runs));
    } catch (error) {
      return setText(this.#complaint, wordsOf(error));
    }
    const before = this.#scenario.value;
    const groups = new Map(this.#scene?.experiments.map(({ name, group }) => [name, group]));
    this.#scenario.replaceChildren(...grouped(this.#offers.map((offer) => ({ ...offer, group: groups.get(offer.name) ?? null, mode: 0, shows_mode: true }))));
    // What was chosen stays until another scenario is loaded; the values may be others.
    const other = this.#loaded !== loaded;
    this.#loaded = loaded;
    const wanted = (other ? [loaded, before] : [before, loaded]).find((name) => this.#offers.some((offer) => offer.name === name));
    if (wanted) this.#scenario.value = wanted;
    this.#scenario.disabled = this.#start.disabled = this.#offers.length === 0;
    this.#choose(other ? null : this.#chosen());
    return undefined;
  }

  /** Names of the parameters that are ticked. */
  #chosen() {
    return [...this.#boxes].flatMap(([name, { box }]) => (box.checked ? [name] : []));
  }

  /** Shows a scenario's limits and parameters, these of them ticked. @param {string[] | null} [ticked] */
  #choose(ticked = null) {
    const offer = this.#offers.find(({ name }) => name === this.#scenario.value);
    if (!offer) return;
    const limits = Object.entries(offer.limits).map(([name, { min, max }]) => [name, ...(min === null ? [] : [`≥ ${formatFloat(min)}`]), ...(max === null ? [] : [`≤ ${formatFloat(max)}`])].join(' '));
    setText(this.#limits, t('limits: {}', limits.join(', ')));
    // It scrolls, so keys must reach it; only now has it words.
    this.#limits.tabIndex = 0;
    this.#boxes.clear();
    this.#parameters.replaceChildren(create('legend', { textContent: t('Parameters') }), ...offer.groups.flatMap(({ title, parameters }, group) => [
      create('h3', { textContent: said(title) }),
      create('div', { className: 'tune-choice' }, ...parameters.map(({ name, now }, index) => this.#line(name, now, ticked?.includes(name) ?? (group === 0 && index < TICKED)))),
    ]));
    this.#showValues();
    if (ticked === null) this.#runs.value = String(offer.runs);
  }

  /** A parameter to choose. @param {string} name @param {number} now @param {boolean} checked */
  #line(name, now, checked) {
    const parameter = this.#table.get(name);
    const box = create('input', { type: 'checkbox', checked });
    const value = create('span', { className: 'hint' });
    this.#boxes.set(name, { box, value, now, from: now });
    return create('label', { title: parameter ? said(parameter.description) : '' }, box, ` ${name} `, value);
  }

  /** The values to search from, as far as the robot has reported its own. */
  #showValues() {
    for (const [name, line] of this.#boxes) {
      const parameter = this.#table.get(name);
      const held = parameter?.value ?? line.now;
      line.from = Math.fround(held) === Math.fround(line.now) ? line.now : held;
      setText(line.value, `${formatFloat(line.from)} ${unitWords(parameter?.unit ?? '')}`.trim());
    }
  }

  #begin() {
    setText(this.#complaint, '');
    this.#result.hidden = true;
    const over = this.#chosen();
    const moved = over.flatMap((name) => {
      const { now, from } = this.#boxes.get(name) ?? { now: 0, from: 0 };
      return from === now ? [] : [[name, from]];
    });
    this.#show(true);
    const begun_ms = performance.now();
    this.#search = new Search(this.#page, {
      scenario: this.#scenario.value, over, params: Object.fromEntries(moved), aims: this.#aims.value, runs: Number(this.#runs.value), seed: Number(this.#seed.value),
    }, {
      share: (share) => {
        this.#part.value = share;
        const left_s = (performance.now() - begun_ms) / 1e3 * (1 - share) / share;
        setText(this.#left, Number.isFinite(left_s) ? t('at most {} left', duration(left_s)) : '');
      },
      found: (found) => {
        this.#end();
        this.#offer(found);
      },
      failed: (why) => {
        this.#end();
        setText(this.#complaint, said(why));
        this.#complaint.scrollIntoView({ block: 'nearest' });
      },
    });
  }

  #end() {
    this.#search?.end();
    this.#search = null;
    this.#show(false);
  }

  /** @param {boolean} works */
  #show(works) {
    this.#start.disabled = works;
    this.#cancel.hidden = this.#part.hidden = !works;
    this.#part.value = 0;
    setText(this.#left, '');
  }

  /** What was found last. @type {Found | null} */
  #found = null;

  /** @param {Found} found */
  #offer(found) {
    this.#found = found;
    const { robot_file, held_out: { seeds, passed_now, passed_tuned } } = found;
    const save = clickable({ id: 'tune-save', textContent: t('Save as robot file') }, () => saveFile(`${this.#scene?.robot ?? 'robot'}-tuned.toml`, new Blob([robot_file ?? ''], { type: 'application/toml' })));
    const none = create('span', { className: 'hint', textContent: t('no robot file: more of the unseen robots fail than before') });
    this.#allow();
    const worse = certainlyWorse(found);
    this.#result.replaceChildren(
      create('p', { className: passed_tuned < seeds.length ? 'failed' : worse.length > 0 ? '' : 'passed', textContent: t('on {} robots that the search has not seen: {} passed, {} pass', seeds.length, passed_now, passed_tuned) }),
      ...(worse.length > 0 ? [create('p', { className: 'complaint', textContent: t('certainly worse than before: {}', worse.join(', ')) })] : []),
      ...resultTables(found, (name) => unitWords(this.#table.get(name)?.unit ?? '')),
      create('div', { className: 'row' }, this.#set, this.#curves, robot_file === null ? none : save),
      create('p', { className: 'hint', textContent: t('{} runs of the search. Lines whose interval excludes zero are certain; the others may be chance.', found.runs) }));
    this.#result.hidden = false;
    this.#result.scrollIntoView({ block: 'start' });
  }

  /** Drives the first of the unseen robots with the values before and after. */
  async #showCurves() {
    const { scenario, parameters, held_out: { seeds: [seed = 0] } } = this.#found ?? { scenario: '', parameters: [], held_out: { seeds: [] } };
    const drive = async (/** @type {string} */ name, /** @type {'now' | 'tuned'} */ which) => {
      const params = Object.fromEntries(parameters.map((each) => [each.name, each[which]]));
      /** @type {{runs: Seeded[]}} */
      const { runs } = await new Promise((found, failed) => {
        const search = new Search(this.#page, { scenario, world: null, rig: null, seed, seeds: 1, params }, {
          share: () => {},
          found: (all) => {
            search.end();
            found(all);
          },
          failed: (why) => failed(new Error(why)),
        });
      });
      return runs.map((run) => ({ ...run, name, about: {}, parameters: params, metrics: {} }));
    };
    setText(this.#complaint, '');
    this.#curves.disabled = true;
    try {
      this.compare([...await drive(`${t('before')}, ${t('seed {}', seed)}`, 'now'), ...await drive(t('after'), 'tuned')]);
    } catch (error) {
      setText(this.#complaint, wordsOf(error));
    }
    this.#allow();
  }

  #setOnRobot() {
    setText(this.#complaint, '');
    this.#sent.clear();
    for (const { name, tuned } of this.#found?.parameters ?? []) {
      const id = this.#table.get(name)?.id;
      if (id === undefined) continue;
      this.#sent.add(name);
      this.#send({ type: 'set_param', id, value: tuned });
    }
  }
}

/** A time as a person says it. @param {number} s */
function duration(s) {
  return s < 90 ? `${format(s, 0)} s` : `${format(s / 60, 0)} min`;
}
