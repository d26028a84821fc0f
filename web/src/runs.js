// @ts-check
/**
 * Runs that are kept: behind the curves of the plots, and side by side in a dialog, with those of this computer's recordings. And
 * the scenario's experiment with twenty seeds, each of which can become the run of this page.
 */
import { Comparison } from './comparison.js';
import { complaint, dialog } from './dialog.js';
import { clickable, create, element, setText } from './dom.js';
import { MOST } from './kept.js';
import { recallKept, storeKept } from './kept_store.js';
import { Store } from './store.js';
import { said, t } from './text.js';
import { Search } from './tune_search.js';
import { isSite } from './worker_link.js';

/** @typedef {import('./kept.js').Run} Run */
/** @typedef {import('./types.js').RecordingContent} Content */
/** @typedef {import('./types.js').ModeEntry} ModeEntry */
/** @typedef {{seed: number, pass: boolean, columns: string[], rows: import('./types.js').Cell[][]}} Seeded */

const SEEDS = 20;

/** @param {Content | Seeded} content @param {ModeEntry[]} modes */
export function storeOf({ columns, rows }, modes) {
  const store = new Store();
  store.begin(columns, modes);
  for (const row of rows) store.push(row);
  return store;
}

export class Runs {
  #dialog = dialog('runs-dialog', t('Runs side by side'));
  #chips = create('div', { className: 'row', id: 'kept-runs' });
  #hint = create('p', { className: 'hint' });
  #complaint = complaint();
  #comparison = new Comparison();
  #keep = element('keep-run', HTMLButtonElement);
  #open = element('runs', HTMLButtonElement);
  #many = create('button', { type: 'button', id: 'seeds-start', className: 'lab-only', textContent: t('Twenty seeds') });
  #part = create('progress', { max: 1, hidden: true });
  #seeds = element('seeds', HTMLDivElement);
  /** @type {Run[]} */
  #kept = [];
  /** They are recordings: this run is not beside them. */
  #recorded = false;
  #now;
  #modes;
  #send;
  #plots;
  #map;
  #complain;
  /** @type {import('./types.js').Scene | null} */
  #scene = null;
  /** @type {Search | null} */
  #search = null;
  /** The robot's. @type {import('./types.js').Parameter[]} */
  #table = [];
  /** The number of this page, which has to be in control. */
  page = 0;

  /**
   * @param {() => Run | null} now the run of this page so far
   * @param {() => ModeEntry[]} modes
   * @param {import('./panel.js').Send} send
   * @param {import('./plots.js').Plots} plots
   * @param {import('./map.js').WorldMap} map
   * @param {(text: string) => void} complain
   */
  constructor(now, modes, send, plots, map, complain) {
    this.#now = now;
    this.#modes = modes;
    this.#send = send;
    this.#plots = plots;
    this.#map = map;
    this.#complain = complain;
    this.#part.setAttribute('aria-label', t('Twenty seeds'));
    this.#many.title = t('The scenario\'s experiment with twenty robots that differ as real ones do: their range in the plots, and each of them on the map');
    this.#many.hidden = isSite;
    this.#dialog.body.append(create('div', { className: 'row' }, this.#chips, this.#many, this.#part), this.#hint, this.#complaint, this.#comparison.body);
    this.#keep.addEventListener('click', () => {
      const run = now();
      this.#recorded = false;
      if (run) this.#take([run]);
    });
    this.#open.addEventListener('click', () => this.open());
    this.#many.addEventListener('click', () => this.#drive());
    this.#show();
    // What stores nothing says so when a run is kept.
    recallKept().then(({ runs, recorded }) => {
      this.#recorded ||= recorded;
      this.#set([...runs, ...this.#kept]);
    }, () => {});
  }

  open() {
    this.#dialog.open();
    this.#show();
  }

  /** Compares recordings, or runs of the station; one with the run of this page. @param {((Content | Seeded) & Omit<Run, 'store'>)[]} contents with what people call them */
  compare(contents) {
    this.#recorded = contents.length > 1;
    this.#kept = [];
    this.#take(contents.map((content) => ({ ...content, store: storeOf(content, this.#modes()) })));
    this.open();
  }

  /** @param {import('./types.js').Scene | null} scene */
  setScene(scene) {
    if (scene?.choice.scenario !== this.#scene?.choice.scenario) this.#showSeeds([]);
    this.#scene = scene;
  }

  /** @param {import('./types.js').Parameter[]} table */
  setParameters(table) {
    this.#table = table;
  }

  /** @param {Run[]} runs */
  #take(runs) {
    this.#set([...this.#kept, ...runs]);
    storeKept({ runs: this.#kept, recorded: this.#recorded }).catch(() => this.#complain('this browser stores no runs: those that are kept are lost when the page is loaded again'));
  }

  /** @param {Run[]} runs */
  #set(runs) {
    this.#kept = runs.slice(-MOST);
    for (const { name } of runs.slice(0, -MOST)) this.#complain(`no longer kept: ${name}; at most ${MOST} runs are`);
    this.#show();
  }

  #show() {
    this.#plots.overlay.kept = this.#kept.map(({ store }) => store);
    setText(this.#open, this.#kept.length === 0 ? t('Runs') : t('Runs: {}', this.#kept.length));
    this.#chips.replaceChildren(...this.#kept.map((run, index) => {
      const chip = create('button', { type: 'button', className: 'place', title: t('Take this run out') }, create('b', { textContent: String(index + 1) }), run.name, ' ×');
      chip.addEventListener('click', () => {
        this.#kept = this.#kept.filter((each) => each !== run);
        this.#take([]);
        this.#open.focus();
      });
      return chip;
    }));
    setText(this.#hint, this.#kept.length === 0 ? t('Keep a run, change something, and run again: the kept one stays behind the curves, from ON on, and is compared here with the new one.') : '');
    // What is not open has no width for a plot.
    const current = this.#dialog.dialog.open && this.#kept.length > 0 && !this.#recorded ? this.#now() : null;
    if (this.#dialog.dialog.open) this.#comparison.show([...this.#kept, ...(current ? [{ ...current, name: t('this run') }] : [])]);
    this.#plots.draw();
  }

  #drive() {
    const { choice } = this.#scene ?? {};
    if (!choice || this.#search) return;
    // What belongs to the robot is measured for each of them.
    const params = Object.fromEntries(this.#table.flatMap(({ name, value, of_robot }) => (value === null || of_robot ? [] : [[name, Number(value.toPrecision(7))]])));
    setText(this.#complaint, '');
    const end = () => {
      this.#search?.end();
      this.#search = null;
      this.#part.hidden = true;
      this.#many.disabled = false;
    };
    this.#part.hidden = false;
    this.#many.disabled = true;
    const { scenario, world, rig, seed } = choice;
    this.#search = new Search(this.page, { scenario, world, rig, seed, seeds: SEEDS, params }, {
      share: (share) => { this.#part.value = share; },
      found: ({ runs }) => {
        end();
        this.#showSeeds(runs);
        this.#dialog.dialog.close();
        // Their time counts from ON, which may be out of sight.
        const from_s = this.#plots.overlay.shift_s(this.#plots.store);
        this.#plots.zoom(from_s - 1, from_s + Math.max(...this.#plots.overlay.seeds.map((store) => store.newest_s)));
      },
      failed: (why) => {
        end();
        setText(this.#complaint, said(why));
      },
    });
  }

  /** @param {Seeded[]} runs */
  #showSeeds(runs) {
    const stores = runs.map((run) => storeOf(run, this.#modes()));
    this.#plots.overlay.setSeeds(stores);
    this.#map.setSeeds(stores);
    this.#seeds.hidden = runs.length === 0;
    const hide = clickable({ className: 'small', textContent: t('Hide') }, () => this.#showSeeds([]));
    this.#seeds.replaceChildren(create('span', { className: 'hint', textContent: t('the experiment with seeds') }), ...runs.map(({ seed, pass }) => clickable({
      className: `small ${pass ? '' : 'bad'}`, textContent: String(seed), title: t(pass ? 'Seed {} keeps all limits: run it here' : 'Seed {} misses a limit: run it here', seed),
    }, () => this.#become(seed))), hide);
    this.#plots.draw();
  }

  /** This page's robot is that of the seed, and drives the experiment. @param {number} seed */
  #become(seed) {
    if (!this.#scene) return;
    const { scenario, world, rig } = this.#scene.choice;
    this.#send({ type: 'reset', scenario, world, rig, seed });
    this.#send({ type: 'play' });
  }
}
