// @ts-check
/**
 * The plots: one time axis, synchronised cursors. The view follows the newest data, or holds while data keeps arriving.
 * A layout, one for each mode, defines the plots.
 */
import { BAND_PX, StateBand } from './band.js';
import { clickable, create, element, setText } from './dom.js';
import { LONGEST_S, LOOP_PLOTS, OWN_PLOTS, OWN_PROGRAM, PLOTS, SHORTEST_S, Shelf, unitsOf } from './layout.js';
import { Overlay } from './overlay.js';
import { portName } from './signals.js';
import { PlotPanel } from './plot.js';
import { t } from './text.js';
import { onThemeChange } from './theme.js';
import { format } from './units.js';

/** @typedef {import('./store.js').Store} Store */
/** @typedef {import('./layout.js').Layout} Layout */
/** @typedef {import('./layout.js').PlotSpec} PlotSpec */

/** In place of a window of time: all of a log. */
const WHOLE = 'whole';
/** A plot is at least so high: more of them scroll [px]. */
const LEAST_PX = 110;
/** Part of the window that an arrow key moves by. */
const KEY_PAN = 0.1;

export class Plots {
  #root;
  store;
  shelf = new Shelf();
  /** @type {PlotPanel[]} */
  #panels = [];
  #band;
  #choices = element('plot-choice', HTMLDivElement);
  #window = element('window', HTMLSelectElement);
  #time = element('cursor-time', HTMLOutputElement);
  /** The mode the plots are shown for. */
  #mode = -1;
  /** @type {Layout} */
  layout = { window_s: 20, plots: [] };
  #following = true;
  /** The visible time. @type {[number, number]} */
  range_s = [0, 20];
  /** Other runs, behind the curves. */
  overlay = new Overlay();
  /** Differences are counted from here. @type {number | null} */
  mark_s = null;
  /** Duration of the log that is shown [s]; null: live. @type {number | null} */
  #whole_s = null;
  /** All of it is in sight, and not a window around the playhead. */
  #wholly = false;
  #onFollow;
  #redraw;
  /** A plot's title takes another line where its curves' names need one. */
  #heads = new ResizeObserver(() => this.#fit());
  /** Each plot that is drawn says that its cursor moves: then the numbers wait for the last of them. */
  #draws = false;
  /** What the curves were drawn of. @type {unknown[]} */
  #drawn = [];
  /** Opens the dialog of a plot. @type {(panel: PlotPanel | null) => void} */
  edit = () => {};

  /**
   * @param {HTMLElement} root
   * @param {Store} store
   * @param {() => void} redraw asks for a frame
   * @param {(following: boolean) => void} onFollow
   */
  constructor(root, store, redraw, onFollow) {
    this.#root = root;
    this.store = store;
    this.#redraw = redraw;
    this.#onFollow = onFollow;
    this.#band = new StateBand(store, this);
    this.#show(this.layout);
    new ResizeObserver(() => this.#fitAnew()).observe(root);
    onThemeChange(() => this.draw());
    this.#window.addEventListener('change', () => {
      this.#wholly = this.#window.value === WHOLE;
      if (this.#wholly) this.follow(true);
      else this.setWindow(Number(this.#window.value));
    });
    root.addEventListener('keydown', (event) => this.#press(event));
  }

  get modes() {
    return this.shelf.modes;
  }

  /** @param {import('./types.js').ModeEntry[]} modes */
  set modes(modes) {
    this.shelf.modes = modes;
  }

  get following() {
    return this.#following;
  }

  /** A log of this duration is shown [s], at first all of it; null: live. */
  set whole_s(/** @type {number | null} */ duration_s) {
    if (duration_s === this.#whole_s) return;
    this.#whole_s = duration_s;
    this.#wholly = duration_s !== null;
    this.#showWindow();
  }

  /** Some plot has an axis on the right. */
  get rightAxis() {
    return this.layout.plots.some(({ signals }) => unitsOf(signals).length > 1);
  }

  /** What is seen of a plot's axes. @param {string} title */
  scales(title) {
    const scales = this.#panels.find(({ spec }) => spec.title === title)?.plot.scales ?? {};
    return Object.fromEntries(Object.entries(scales).map(([name, { min, max }]) => [name, [min, max]]));
  }

  /** @param {boolean} following */
  follow(following) {
    this.#following = following;
    if (following) for (const panel of this.#panels) panel.resetAxis();
    this.#onFollow(following);
    this.#drawn = [];
    this.#redraw();
  }

  /** @param {number} window_s */
  setWindow(window_s) {
    this.use({ ...this.layout, window_s });
    this.follow(true);
  }

  /** Shows this time, and holds. @param {number} from_s @param {number} to_s */
  zoom(from_s, to_s) {
    if (to_s - from_s >= SHORTEST_S) this.range_s = [from_s, to_s];
    this.follow(false);
  }

  /** Zooms in time about an instant, or the window while the newest data is followed. @param {number} factor @param {number} at_s */
  scale(factor, at_s) {
    const [from_s, to_s] = this.range_s;
    if (this.#following && !this.#wholly) {
      this.layout = { ...this.layout, window_s: Math.min(LONGEST_S, Math.max(SHORTEST_S, this.layout.window_s * factor)) };
      this.#showWindow();
      this.#redraw();
    } else {
      this.zoom(at_s - (at_s - from_s) * factor, at_s + (to_s - at_s) * factor);
    }
  }

  /** Sets the mark, or takes it away where it is. @param {number | null} t_s */
  mark(t_s) {
    const near_s = (this.range_s[1] - this.range_s[0]) / 100;
    this.mark_s = t_s === null || (this.mark_s !== null && Math.abs(t_s - this.mark_s) < near_s) ? null : t_s;
    this.#redraw();
  }

  /** New data is drawn once it is half a pixel further, which in ten minutes of it is twice a second; its numbers are at once. */
  update() {
    const { slow, readings, steps, stretches, limits, experiment_end_s, playhead_s } = this.store;
    const half_px_s = Number((this.range_s[1] - this.range_s[0]).toFixed(3)) / (2 * Math.max(1, this.#band.plot.bbox.width));
    const end_s = this.#following ? Infinity : this.range_s[1];
    const now = [...[slow.t.at(-1) ?? 0, readings.newest_s].map((t_s) => Math.floor(Math.min(t_s, end_s) / half_px_s)), slow.t[0], half_px_s, ...(this.#following ? [] : this.range_s),
      this.mark_s, playhead_s, steps.length, stretches.length, limits?.length, experiment_end_s, this.#whole_s];
    if (now.length === this.#drawn.length && now.every((each, index) => each === this.#drawn[index])) return this.label();
    this.draw();
    this.#drawn = now;
  }

  draw() {
    const { window_s } = this.layout;
    if (this.#following && this.#whole_s !== null) {
      const span_s = Math.min(this.#wholly ? this.#whole_s : window_s, LONGEST_S);
      const from_s = Math.min(Math.max(0, this.store.playhead_s - span_s / 2), Math.max(0, this.#whole_s - span_s));
      this.range_s = [from_s, from_s + Math.max(span_s, SHORTEST_S)];
    } else if (this.#following) {
      const to_s = Math.max(this.store.newest_s, window_s);
      this.range_s = [to_s - window_s, to_s];
    }
    this.#draws = true;
    for (const panel of this.#panels) panel.draw();
    if (this.#choices.childElementCount !== this.#offered.length) this.#offerChoices();
    this.#band.draw();
    this.#draws = false;
    this.label();
  }

  /** The pointer is at another time. */
  onPoint = () => {};

  /** A moved cursor changes the numbers shown, not the curves. */
  label() {
    if (this.#draws) return;
    this.onPoint();
    for (const panel of this.#panels) panel.label();
    this.#showTime();
  }

  /** The time at the pointer [s]. */
  get pointed_s() {
    const { left } = this.#band.plot.cursor;
    return left !== undefined && left >= 0 ? this.#band.plot.posToVal(left, 'x') : null;
  }

  #showTime() {
    const at_s = this.pointed_s;
    const difference = this.mark_s === null ? '' : `Δ ${format((at_s ?? this.range_s[1]) - this.mark_s, 2)} s`;
    setText(this.#time, [at_s === null ? '' : `${format(at_s, 2)} s`, difference, at_s === null ? '' : this.#band.nameAt(at_s)].filter(Boolean).join('  '));
  }

  /** Shows the plots that the mode begins with, or those that were chosen in it. @param {number} mode */
  setMode(mode) {
    if (mode === this.#mode) return;
    this.#mode = mode;
    this.#show(this.shelf.ofMode(mode));
  }

  /** From now on this layout is the mode's; null: as it begins. @param {Layout | null} layout */
  use(layout) {
    this.shelf.keep(this.#mode, layout);
    this.#show(this.shelf.ofMode(this.#mode));
  }

  /** Puts a plot in the place of another; null: adds it, or takes the other away. @param {PlotSpec | null} old @param {PlotSpec | null} spec */
  change(old, spec) {
    const plots = old === null ? [...this.layout.plots, ...(spec ? [spec] : [])] : this.layout.plots.flatMap((each) => (each === old ? spec ?? [] : each));
    this.use({ ...this.layout, plots });
  }

  /** Plots the numbers that a port prints, in a plot of their own. @param {number} usart */
  showPrinted(usart) {
    const title = portName(usart);
    const signals = this.store.readings.printedBy(usart);
    const old = this.layout.plots.find((each) => each.title === title) ?? null;
    this.change(old, { title, signals, min: null, max: null, weight: 4 });
  }

  /** @param {Layout} layout */
  #show(layout) {
    this.layout = layout;
    for (const panel of this.#panels) {
      panel.plot.destroy();
      for (const part of panel.parts) part.remove();
    }
    this.#panels = layout.plots.map((spec) => new PlotPanel(spec, this.store, this));
    this.#root.replaceChildren(...this.#panels.flatMap((panel) => panel.parts), this.#band.body);
    this.#heads.disconnect();
    for (const { head } of this.#panels) this.#heads.observe(head);
    this.#showWindow();
    this.#offerChoices();
    // What has nothing to show has no name in a title, and takes no place there.
    for (const panel of this.#panels) panel.draw();
    this.label();
    this.#fitAnew();
    this.#band.plot.redraw(false, true);
    this.#redraw();
  }

  #showWindow() {
    const value = String(this.layout.window_s);
    for (const each of this.#window.querySelectorAll('.other, .whole')) each.remove();
    if (this.#whole_s !== null) this.#window.prepend(create('option', { className: 'whole', value: WHOLE, textContent: t('whole log') }));
    if (![...this.#window.options].some((each) => each.value === value)) {
      this.#window.append(create('option', { className: 'other', value, textContent: `${format(this.layout.window_s, 1)} s` }));
    }
    this.#window.value = this.#wholly ? WHOLE : value;
  }

  /** The plots that there are from the start. */
  get #offered() {
    if (this.#mode === OWN_PROGRAM) return OWN_PLOTS;
    return this.store.readings.loops.t.length > 0 ? [...PLOTS, ...LOOP_PLOTS] : PLOTS;
  }

  /** One button for each of them: shown or not. */
  #offerChoices() {
    const offered = this.#offered;
    const own = [...this.#choices.querySelectorAll('button')];
    const same = own.map(({ value }) => value).join() === offered.map(({ title }) => title).join();
    const buttons = same ? own : offered.map((spec) => {
      const button = clickable({ value: spec.title, textContent: t(spec.title), title: t('Plot {}, or not', t(spec.title)) }, () => {
        const shown = this.layout.plots.find((each) => each.title === spec.title);
        this.change(shown ?? null, shown ? null : { ...spec });
      });
      return button;
    });
    if (!same) this.#choices.replaceChildren(...buttons);
    for (const button of buttons) button.setAttribute('aria-pressed', String(this.layout.plots.some(({ title }) => title === button.value)));
  }

  /** The titles may be lower again. */
  #fitAnew() {
    for (const { head } of this.#panels) head.style.minHeight = '';
    this.#fit();
  }

  #fit() {
    const width = this.#root.clientWidth;
    const weights = this.#panels.reduce((sum, { spec }) => sum + spec.weight, 0);
    const heads_px = this.#panels.map(({ head }) => head.offsetHeight);
    // A title that has taken another line keeps it: the plots do not jump with the length of a number.
    this.#panels.forEach(({ head }, index) => { head.style.minHeight = `${heads_px[index]}px`; });
    const free_px = this.#root.clientHeight - BAND_PX - heads_px.reduce((sum, px) => sum + px, LEAST_PX * heads_px.length);
    for (const { plot, spec } of this.#panels) plot.setSize({ width, height: LEAST_PX + Math.max(0, Math.floor((free_px * spec.weight) / weights)) });
    this.#band.plot.setSize({ width, height: BAND_PX });
  }

  /** Keys move the view as the pointer does. @param {KeyboardEvent} event */
  #press(event) {
    if (event.target !== this.#root || event.ctrlKey || event.metaKey || event.altKey) return;
    const [from_s, to_s] = this.range_s;
    const pan_s = KEY_PAN * (to_s - from_s);
    /** @type {Record<string, () => void>} */
    const keys = {
      ArrowLeft: () => this.zoom(from_s - pan_s, to_s - pan_s),
      ArrowRight: () => this.zoom(from_s + pan_s, to_s + pan_s),
      '+': () => this.scale(0.8, (from_s + to_s) / 2),
      '-': () => this.scale(1.25, (from_s + to_s) / 2),
      m: () => this.mark((from_s + to_s) / 2),
      Escape: () => this.mark(null),
    };
    const act = keys[event.key];
    if (!act) return;
    event.preventDefault();
    event.stopPropagation();
    act();
  }
}
