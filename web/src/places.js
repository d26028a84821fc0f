// @ts-check
/** The controls of modes 7 and 8: a route by clicks on the map, a goal by click, by numbers or from the report, and the lane. */
import { number, read, setLimits, write } from './decimal.js';
import { clickable, create, element, setText } from './dom.js';
import { format, pair } from './units.js';
import { t } from './text.js';

/** @typedef {import('./types.js').ModeEntry} ModeEntry */
/** @typedef {import('./types.js').Route} Route */
/** @typedef {import('./types.js').Scene} Scene */
/** @typedef {import('./map.js').WorldMap} WorldMap */
/** @typedef {import('./panel.js').Send} Send */
/** @typedef {[number, number]} Point From the robot's origin [m]. */

/** The goals of the report's experiment [m]. @type {Point[]} */
const GOALS = [[1, 1], [0.5, -0.5], [-1, -1]];
/** The report's square [m]. @type {Point[]} */
const SQUARE = [[1, 0], [1, 1], [0, 1], [0, 0]];

export class Places {
  #send;
  #map;
  #root = element('places', HTMLDivElement);
  /** The mode that the controls are for. @type {ModeEntry | null} */
  #mode = null;
  /** @type {Scene | null} */
  #scene = null;
  /** The route that is being made, not sent yet. @type {Point[]} */
  #draft = [];
  #repeat = create('input', { type: 'checkbox', id: 'route-repeat' });
  #relative = create('input', { type: 'checkbox', id: 'route-relative' });
  #list = create('div', { id: 'route-places', className: 'row' });
  #set = create('button', { type: 'button', id: 'route-set', textContent: t('Set route'), className: 'go' });
  #x = number('goal-x', 1, -1, 1);
  #y = number('goal-y', 1, -1, 1);

  /** @param {Send} send @param {WorldMap} map */
  constructor(send, map) {
    this.#send = send;
    this.#map = map;
    this.#set.addEventListener('click', () => this.#sendRoute());
    for (const box of [this.#repeat, this.#relative]) box.addEventListener('change', () => this.#showDraft());
  }

  /** @param {Scene | null} scene */
  setScene(scene) {
    this.#scene = scene;
    const [goal] = scene?.goals ?? [];
    // The form starts with the experiment's first goal.
    for (const [index, input] of [this.#x, this.#y].entries()) if (goal) write(input, rounded(goal[index] ?? 0));
    if (this.#mode) this.layOut(this.#mode);
  }

  /** Lays out a mode's inputs. @param {ModeEntry | null} mode */
  layOut(mode) {
    const places = mode?.reference?.kind === 'goal';
    this.#mode = places ? mode : null;
    this.#root.hidden = !places;
    this.#draft = [];
    if (mode && places && mode.route !== null) {
      this.#layOutRoute();
      this.#map.setPick((at) => this.#append(at), true);
    } else if (mode && places) {
      this.#layOutGoal(mode);
      this.#map.setPick(([x_m, y_m]) => this.#sendGoal([rounded(x_m), rounded(y_m)]));
    } else {
      this.#map.setPick(null);
    }
    this.#showDraft();
  }

  /** @param {ModeEntry} mode */
  #layOutGoal(mode) {
    for (const input of [this.#x, this.#y]) {
      setLimits(input, mode.reference?.min ?? -1, mode.reference?.max ?? 1);
      input.setAttribute('aria-label', t(input === this.#x ? 'goal, x: forward of the robot\'s origin, in m' : 'goal, y: left of the robot\'s origin, in m'));
    }
    const form = create('form', { className: 'row', id: 'goal' }, create('label', {}, `${t('goal x')} `, this.#x), create('label', {}, 'y ', this.#y), ' m',
      create('button', { type: 'submit', textContent: t('Set goal'), className: 'go' }));
    form.addEventListener('submit', (event) => {
      event.preventDefault();
      this.#sendGoal([read(this.#x), read(this.#y)]);
    });
    const own = this.#scene?.goals.filter((goal) => !GOALS.some((each) => same(each, goal))) ?? [];
    const presets = create('div', { className: 'row' }, ...[...GOALS, ...own].map((goal) => clickable({ textContent: inWords(goal), title: t('Set this goal') }, () => this.#sendGoal(goal))));
    if (mode.lane) {
      const lane = clickable({ id: 'lane', textContent: t('LANE'), title: t('Follow a lane of boxes') }, () => this.#send({ type: 'lane' }));
      presets.append(lane);
    }
    this.#root.replaceChildren(form, presets, create('span', { className: 'hint', textContent: t('A click on the map sets the goal: x forward, y left of the robot\'s origin.') }));
  }

  #layOutRoute() {
    const button = (/** @type {string} */ text, /** @type {string} */ title, /** @type {() => void} */ act) => clickable({ textContent: text, title }, act);
    const own = this.#scene?.routes.map((route, index) => button(this.#scene?.routes.length === 1 ? t('Scenario\'s') : t('Scenario\'s {}', index + 1), t('Take the scenario\'s route'), () => this.#take(route))) ?? [];
    this.#root.replaceChildren(
      create('div', { className: 'row' },
        button(t('Square 1 m'), t('Take the square of the report'), () => this.#take({ repeat: this.#repeat.checked, relative: this.#relative.checked, waypoints: SQUARE.map(([x_m, y_m]) => ({ x_m, y_m, heading_rad: null })) })),
        ...own, button(t('Clear'), t('Start over'), () => this.#change([])),
        create('label', { title: t('Starts over at the end') }, this.#repeat, ` ${t('repeat')}`),
        create('label', { title: t('As seen from where the robot starts, not from its origin') }, this.#relative, ` ${t('relative')}`), this.#set),
      this.#list,
    );
  }

  /** @param {Point} goal */
  #sendGoal(goal) {
    const [x_m, y_m] = goal;
    write(this.#x, x_m);
    write(this.#y, y_m);
    this.#send({ type: 'goal', x_m, y_m });
  }

  /** @param {Route} route */
  #take(route) {
    this.#repeat.checked = route.repeat;
    this.#relative.checked = route.relative;
    this.#change(route.waypoints.map(({ x_m, y_m }) => [x_m, y_m]));
  }

  /** @param {Point} at */
  #append([x_m, y_m]) {
    if (this.#draft.length < (this.#mode?.route ?? 0)) this.#change([...this.#draft, [rounded(x_m), rounded(y_m)]]);
  }

  /** Sends the route that is drawn, if there is one. */
  sendDraft() {
    if (this.#draft.length > 0) this.#sendRoute();
  }

  #sendRoute() {
    const waypoints = this.#draft.map(([x_m, y_m]) => ({ x_m, y_m }));
    this.#send({ type: 'route', repeat: this.#repeat.checked, relative: this.#relative.checked, waypoints });
    this.#change([]);
  }

  /** @param {Point[]} draft */
  #change(draft) {
    this.#draft = draft;
    this.#showDraft();
  }

  #showDraft() {
    const [draft, repeat, relative] = [this.#draft, this.#repeat.checked, this.#relative.checked];
    this.#set.disabled = draft.length === 0;
    this.#map.setDraft(draft.length === 0 ? null : { repeat, relative, waypoints: draft.map(([x_m, y_m]) => ({ x_m, y_m, heading_rad: null })) });
    if (draft.length === 0) {
      setText(this.#list, t('Clicks on the map add waypoints, {} at most.', this.#mode?.route ?? 0));
      return;
    }
    this.#list.replaceChildren(...draft.map((at, index) => clickable({ className: 'place', title: t('Remove this waypoint') },
      () => this.#change(draft.filter((_place, each) => each !== index)), create('b', { textContent: String(index + 1) }), inWords(at), ' ×')));
  }
}

/** @param {Point} point */
export function inWords([x_m, y_m]) {
  return pair(format(x_m, decimals(x_m)), format(y_m, decimals(y_m)));
}

/** As many decimals as a centimetre needs. @param {number} value */
function decimals(value) {
  return [0, 1].find((count) => Math.abs(value - Number(value.toFixed(count))) < 0.005) ?? 2;
}

/** To a centimetre. @param {number} value_m */
function rounded(value_m) {
  return Math.round(value_m * 100) / 100;
}

/** @param {Point} a @param {Point} b */
function same(a, b) {
  return Math.hypot(a[0] - b[0], a[1] - b[1]) < 0.005;
}
