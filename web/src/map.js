// @ts-check
/**
 * The map: world, true and estimated pose of the robot, trails, sonars, goal and route. A click picks a position.
 *
 * Goals and routes are sent relative to the robot's origin, which moves, and its odometry errs. A goal is drawn where the
 * robot will actually arrive with its present error: in the frame in which the estimated pose is the true one. The goal in
 * the robot's own frame is drawn dashed, like its estimated pose; so is a route, a plan that does not follow the error.
 * With a real robot the two frames are the same.
 */
import { element } from './dom.js';
import { IDENTITY, compose, inverse, nextTo, place } from './geometry.js';
import { take } from './hand.js';
import { on_s } from './kept.js';
import { inWorld } from './movers.js';
import { Sketch } from './sketch.js';
import { colours, onThemeChange } from './theme.js';
import { watchFingers } from './touch.js';

/** @typedef {import('./types.js').Scene} Scene */
/** @typedef {import('./types.js').Task} Task */
/** @typedef {import('./types.js').Pose} Pose */
/** @typedef {import('./types.js').Route} Route */
/** @typedef {import('./store.js').Store} Store */
/** @typedef {import('./hand.js').Held} Held */
/** @typedef {[number, number]} Point */
/** @typedef {{x_m: number, y_m: number, px_per_m: number}} View Middle [m] and scale. */
/**
 * What is drawn and dragged in place of the robot.
 * @typedef {object} Tool
 * @property {Point[]} bounds What is to be in sight.
 * @property {(at: Point, reach_m: number) => boolean} press
 * @property {(at: Point) => void} drag
 * @property {() => void} release
 * @property {(event: KeyboardEvent) => boolean} key
 * @property {(sketch: Sketch, px: number) => void} draw
 */

/** Free space around what is to be seen [m]. */
const MARGIN_M = 0.12;
/** Margin for the texts above and below the map [px]. */
const [ABOVE_PX, BELOW_PX] = [34, 18];
/** The name of another robot stands so far above it, or below where the readout would hide it [m], and is so high [px]. */
const [NAME_M, NAME_PX] = [0.16, 14];
/** Of a long wall this much to both sides of the point next to the robot is in sight [m]. */
const ALONG_M = 0.5;
/** The view grows in steps of this size [m], so that it does not creep. */
const GROWTH_M = 0.5;
/** The robot is at least so large: else the view follows it, or what is around it and its goal, or it has a ring of that size [px]. */
const LARGE_PX = 40;
/** What is around the robot, with room to pick places, or around its way [m]. */
const [PICKING_M, WAY_M] = [0.8, 0.25];
const ZOOM_STEP = 1.25;
const KEY_PAN_PX = 40;
/** A press that moves no further than this is a click [px]. */
const CLICK_PX = 4;
/** A tool holds what is so near [px]; a finger is thicker. */
const REACH_PX = { mouse: 8, touch: 18 };
/** Minimum time between two places of what is carried [ms]. */
const HAND_MS = 100;
/** The goal in the robot's frame is drawn separately from this distance on [px]. */
const APART_PX = 3;

/** The frame of the world, as far as is seen. @param {Pose} frame */
const isIdentity = ({ x_m, y_m, heading_rad }) => Math.hypot(x_m, y_m) < 0.01 && Math.abs(heading_rad) < 0.01;

export class WorldMap {
  #canvas;
  #sketch;
  #store;
  #redraw;
  /** @type {View | null} Null: everything fits. */
  #view = null;
  /** @type {Task | null} */
  #task = null;
  /** @type {Route | null} */
  #draft = null;
  /** @type {((at: Point) => void) | null} */
  #pick = null;
  /** @type {Tool | null} */
  #tool = null;
  /** Places are picked for a plan. */
  #planning = false;
  /** Where the pointer is [px]. @type {Point | null} */
  #pointer = null;
  /** The view follows the robot; null: where it would be too small otherwise. @type {boolean | null} */
  #follow = null;
  #followButton = element('follow', HTMLButtonElement);
  #pose = element('pose', HTMLOutputElement);
  /** @type {number | null} */
  #above_px = null;
  /** The robot is also shown where it was then [s]. @type {number | null} */
  #hover_s = null;
  /** The same run with other seeds, each with when it was switched on [s]. @type {{store: Store, began_s: number}[]} */
  #seeds = [];
  /** Sends what a hand does in the simulated world; null: it can do nothing there. @type {((line: string) => void) | null} */
  hand = null;
  /** What is held, when that was sent last, and the view before, which stands still meanwhile. @type {{held: Held, sent_ms: number, view: View | null} | null} */
  #hand = null;
  servo_rad = 0;
  /** The number of this page's robot among several. */
  own = 0;
  /** The place of the route that the robot goes to now, from its origin. @type {Point | null} */
  target = null;

  /**
   * @param {HTMLCanvasElement} canvas
   * @param {Store} store
   * @param {() => void} redraw asks for a frame
   */
  constructor(canvas, store, redraw) {
    this.#canvas = canvas;
    const context = canvas.getContext('2d');
    if (!context) throw new Error('the browser has no 2-D canvas');
    this.#sketch = new Sketch(canvas, context);
    this.#store = store;
    this.#redraw = redraw;
    const sizes = new ResizeObserver(() => {
      this.#sketch.resized();
      this.#above_px = null;
      redraw();
    });
    for (const each of [canvas, this.#pose]) sizes.observe(each);
    onThemeChange(redraw);
    this.#makeNavigable();
    this.#makePickable();
  }

  /** @param {Scene | null} scene */
  setScene(scene) {
    // Another of several robots in the same world, or the same world again, is seen as before.
    const same = JSON.stringify(scene?.obstacles) === JSON.stringify(this.#sketch.scene?.obstacles);
    this.#sketch.scene = scene;
    if (!same) this.fit(null);
    this.#redraw();
  }

  /** The body by the robot's parameters. @param {import('./mounts.js').Body | null} body */
  set body(body) {
    this.#sketch.body = body;
  }

  /** @param {Task} task */
  setTask(task) {
    this.#task = task;
    this.#redraw();
  }

  /** A route that is being made. @param {Route | null} draft */
  setDraft(draft) {
    this.#draft = draft;
    this.#redraw();
  }

  /**
   * What a click does with its place, from the robot's origin; null: nothing.
   * @param {((at: Point) => void) | null} pick
   * @param {boolean} [planning] for a route, which does not follow the error of now
   */
  setPick(pick, planning = false) {
    this.#planning = planning;
    this.#pick = pick;
    this.#canvas.classList.toggle('picking', pick !== null);
    this.#redraw();
  }

  /** A tool takes the map's clicks and keys, and draws in place of the robot. @param {Tool | null} tool */
  setTool(tool) {
    this.#tool = tool;
    this.fit();
  }

  /** Shows everything, or follows the robot; null: what makes it large enough. @param {boolean | null} [follow] */
  fit(follow = false) {
    this.#follow = follow;
    this.#view = null;
    // What a tool changes does not move the view.
    if (this.#tool) this.#view = this.#fitted();
    this.#redraw();
  }

  redraw() {
    this.#redraw();
  }

  /** Shows the robots of other seeds, faint. @param {Store[]} seeds */
  setSeeds(seeds) {
    this.#seeds = seeds.map((store) => ({ store, began_s: on_s(store) ?? 0 }));
    this.#redraw();
  }

  /** Shows the robot also where it was then [s]. @param {number | null} t_s */
  hover(t_s) {
    if (t_s === this.#hover_s) return;
    this.#hover_s = t_s;
    this.draw();
  }

  focus() {
    this.#canvas.focus();
  }

  /** The place in the middle. @returns {Point} */
  middle() {
    return this.#toWorld(this.#middle());
  }

  /** A place of the world on the canvas [px]. @param {Point} at @param {View} [view] @returns {Point} */
  worldToCanvas([x_m, y_m], view = this.#view ?? this.#fitted()) {
    const [middle_x, middle_y] = this.#middle();
    return [middle_x + (x_m - view.x_m) * view.px_per_m, middle_y - (y_m - view.y_m) * view.px_per_m];
  }

  /** The place under the pointer, or that Enter picks, in the world and, where it would be picked, from the robot's origin. @returns {{world: Point, own: Point | null} | null} */
  pointed() {
    const at = this.#pointer ?? (this.#pick && this.#canvas.matches(':focus-visible') ? this.#middle() : null);
    const world = at && this.#toWorld(at);
    return world && { world, own: this.#pick && !this.#tool && !isIdentity(this.#pickFrame()) ? this.#fromOrigin(world) : null };
  }

  /** A place from the robot's origin, on the canvas [px]; for tests. @param {Point} at @returns {Point} */
  toCanvas(at) {
    return this.worldToCanvas(place(this.#pickFrame(), at));
  }

  draw() {
    const canvas = this.#canvas;
    const sketch = this.#sketch;
    const ratio = devicePixelRatio;
    const [width = 0, height = 0] = sketch.size.map((each) => Math.round(each * ratio));
    if (canvas.width !== width || canvas.height !== height) {
      canvas.width = width;
      canvas.height = height;
    }
    // Found once: for each frame that is much.
    const whole = this.#view ? null : this.#whole();
    const view = this.#view ?? this.#fitted(whole ?? undefined);
    this.#followButton.setAttribute('aria-pressed', String(whole !== null && this.#follows(whole)));
    const scale = view.px_per_m * ratio;
    sketch.context.setTransform(1, 0, 0, 1, 0, 0);
    sketch.context.clearRect(0, 0, width, height);
    // From here on in metres, y up.
    sketch.context.setTransform(scale, 0, 0, -scale, width / 2 - view.x_m * scale, height / 2 + view.y_m * scale);
    const px = ratio / scale;
    sketch.drawGrid(view, px);
    if (this.#tool) this.#tool.draw(sketch, px);
    else this.#drawScene(view, px);
    // Over walls: it is read there too.
    sketch.drawScale(view);
  }

  /** @param {View} view @param {number} px */
  #drawScene(view, px) {
    const sketch = this.#sketch;
    sketch.drawWorld(px, this.world());
    for (const { other, at, number } of this.others()) sketch.drawOther(other, at, number, px, this.worldToCanvas([at.x_m, at.y_m + NAME_M], view)[1] > this.#above() ? NAME_M : -NAME_M);
    sketch.drawTrail(this.#store.trails.truth, colours.robot, 1.5 * px);
    sketch.drawTrail(this.#store.trails.estimated, colours.dim, px);
    sketch.drawTrail(this.#store.trails.ghost, colours.goal, px);
    // Goals and routes count from the robot's origin.
    if (this.#pick && !isIdentity(this.#origin())) sketch.drawAxes(this.#origin(), px);
    this.#drawTask(px);
    const latest = this.#store.latest;
    const then = this.#hover_s === null ? null : this.#store.poseAt(this.#hover_s);
    // From ON on, as this one.
    const on = this.#seeds.length > 0 ? on_s(this.#store) : null;
    sketch.drawSeeds(this.#seeds.flatMap(({ store, began_s }) => store.poseAt((latest?.t_s ?? 0) - (on === null ? 0 : on - began_s)) ?? []), px);
    if (then) sketch.drawRobot(then, px, 'estimated', false);
    if (!latest) return;
    const estimated = latest.estimated && compose(latest.origin, latest.estimated);
    const seen = latest.truth ?? estimated;
    if (seen) sketch.drawSonars(seen, latest.ranges_m, latest.servo_rad ?? this.servo_rad, px);
    if (latest.ghost) sketch.drawRobot(latest.ghost, px, 'ghost', false);
    if (estimated) sketch.drawRobot(estimated, px, latest.truth ? 'estimated' : 'real', false);
    if (latest.truth) sketch.drawRobot(latest.truth, px, 'real', latest.contact);
    if (seen && view.px_per_m < 0.75 * this.#least) sketch.drawRing(seen, LARGE_PX / 2 * px, px);
    if (estimated && latest.spread) sketch.drawSpread(estimated, latest.origin, latest.spread, px);
    this.#hand?.held.draw(sketch, px);
    if (this.#pick && this.#canvas.matches(':focus-visible')) sketch.drawAim();
  }

  /** Outlines of what stands and moves, where they are. */
  world() {
    return inWorld(this.#sketch.scene, this.#store.readings, this.#store.latest?.t_s ?? 0);
  }

  /** The other robots, where they are known to be; a robot has the same number, and with it its colour, on every page. */
  others() {
    const t_s = this.#store.latest?.t_s ?? 0;
    return (this.#sketch.scene?.others ?? []).flatMap((other, index) => {
      const at = this.#store.readings.placeOf(other.name, t_s);
      return at ? [{ other, at, number: index < this.own ? index : index + 1 }] : [];
    });
  }

  /** Where the readout ends, which may have two rows, and a robot's name below it has room [px]. */
  #above() {
    return this.#above_px ??= this.#pose.offsetTop + this.#pose.offsetHeight + NAME_PX;
  }

  /** @param {number} px */
  #drawTask(px) {
    const sketch = this.#sketch;
    const { route = null, from = null } = this.#task ?? {};
    const goal = this.#task?.goal ?? this.target;
    const began = from && { x_m: from[0], y_m: from[1], heading_rad: from[2] };
    if (route) this.#drawRoute(route, began, false, px);
    if (this.#draft) this.#drawRoute(this.#draft, null, true, px);
    if (!goal) return;
    const robot = this.#robot();
    const at = place(this.#drivenFrame(), goal);
    sketch.drawGoal(at, [robot.x_m, robot.y_m], px);
    const believed = place(this.#origin(), goal);
    if (Math.hypot(at[0] - believed[0], at[1] - believed[1]) > APART_PX * px) sketch.drawBelievedGoal(believed, px);
  }

  /**
   * @param {Route} route
   * @param {Pose | null} began Where the robot stood then, from its origin.
   * @param {boolean} draft
   * @param {number} px
   */
  #drawRoute(route, began, draft, px) {
    const now = this.#store.latest?.estimated ?? IDENTITY;
    const start = compose(this.#origin(), began ?? now);
    const base = route.relative ? start : this.#origin();
    const points = route.waypoints.map(({ x_m, y_m }) => place(base, [x_m, y_m]));
    this.#sketch.drawRoute(points, { from: draft ? null : [start.x_m, start.y_m], repeat: route.repeat, draft }, px);
  }

  /** The robot in the world: its true pose if known, else the estimated one. */
  #robot() {
    const latest = this.#store.latest;
    return latest?.truth ?? (latest?.estimated ? compose(latest.origin, latest.estimated) : this.#start());
  }

  /** Where the odometry began. */
  #start() {
    return this.#sketch.scene?.start ?? IDENTITY;
  }

  /** The frame in which the robot's estimated pose is its true one. */
  #drivenFrame() {
    const latest = this.#store.latest;
    if (!latest) return this.#start();
    return latest.truth && latest.estimated ? compose(latest.truth, inverse(latest.estimated)) : latest.origin;
  }

  /** The robot's origin, by its odometry. */
  #origin() {
    return this.#store.latest?.origin ?? this.#start();
  }

  #pickFrame() {
    return this.#planning ? this.#origin() : this.#drivenFrame();
  }

  /** @param {Point} at @returns {Point} */
  #fromOrigin(at) {
    return place(inverse(this.#pickFrame()), at);
  }

  /** @param {Point} pixel @returns {Point} */
  #toWorld([x_px, y_px]) {
    const view = this.#view ?? this.#fitted();
    const [middle_x, middle_y] = this.#middle();
    return [view.x_m + (x_px - middle_x) / view.px_per_m, view.y_m - (y_px - middle_y) / view.px_per_m];
  }

  /** Scale at which the robot has its least size [px/m]. */
  get #least() {
    const xs = this.#sketch.scene?.footprint_m.map(([x]) => x) ?? [0, 0.25];
    return LARGE_PX / (Math.max(...xs) - Math.min(...xs));
  }

  /** @param {View} whole */
  #follows(whole) {
    // A route that is being made may go anywhere.
    return !this.#tool && (this.#follow ?? (whole.px_per_m < this.#least && !this.#draft));
  }

  /** Everything, or the robot, with where it goes if places are picked. @returns {View} */
  #fitted(whole = this.#whole()) {
    if (!this.#follows(whole)) return whole;
    const { x_m, y_m } = this.#robot();
    if (!this.#pick || this.#follow) return { x_m, y_m, px_per_m: Math.max(whole.px_per_m, this.#least) };
    const way = this.#way();
    const from = this.#task?.from ? compose(this.#origin(), { x_m: this.#task.from[0], y_m: this.#task.from[1], heading_rad: 0 }) : this.#start();
    const around_m = way.length > 0 ? WAY_M : PICKING_M;
    return this.#showing([[x_m, y_m], ...(way.length > 0 ? [/** @type {Point} */ ([from.x_m, from.y_m])] : []), ...way]
      .flatMap(([x = 0, y = 0]) => [[x - around_m, y - around_m], [x + around_m, y + around_m]]), whole.px_per_m, this.#least);
  }

  /** Goal and places of the route in the world, without the robot's error. @returns {Point[]} */
  #way() {
    const { goal = null, route = null } = this.#task ?? {};
    return [...(goal ? [goal] : []), ...(route?.waypoints.map(({ x_m, y_m }) => /** @type {Point} */ ([x_m, y_m])) ?? [])].map((at) => place(this.#origin(), at));
  }

  /** What is around the robot in sight, with room to pick places where that is what a click does. @returns {View} */
  #whole() {
    const start = this.#start();
    const robot = this.#robot();
    const around_m = this.#pick ? 1.3 : 0.35;
    const coarse = (/** @type {Point} */ point) => point.map((each) => Math.round(each / GROWTH_M) * GROWTH_M);
    return this.#showing(this.#tool?.bounds ?? [
      ...(this.#sketch.scene?.obstacles.flatMap(({ corners_m, closed }) => corners_m.flatMap((corner, index) => {
        const next = corners_m[index + 1] ?? (closed ? corners_m[0] : undefined);
        return next ? nextTo(corner, next, [start.x_m, start.y_m], ALONG_M) : [];
      })) ?? []),
      ...(this.#sketch.scene?.movers?.flatMap(({ waypoints }) => waypoints.map(({ at }) => [at.x_m, at.y_m])) ?? []),
      [start.x_m - around_m, start.y_m - around_m], [start.x_m + around_m, start.y_m + around_m],
      ...[...this.others().map(({ at }) => at), robot].map(({ x_m, y_m }) => coarse([x_m, y_m])), ...[...this.#trailCorners(), ...this.#way()].map(coarse),
    ]);
  }

  /** The view of all these points, its scale in a range [px/m]. @param {number[][]} points @param {number} [least] @param {number} [most] @returns {View} */
  #showing(points, least = 0, most = Infinity) {
    const xs = points.map(([x]) => x ?? 0);
    const ys = points.map(([, y]) => y ?? 0);
    const [left, right, low, high] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
    const above_px = this.#sketch.scene?.others?.length ? this.#above() : ABOVE_PX;
    const [width_px, whole_px] = this.#sketch.size;
    const height_px = Math.max(whole_px - above_px - BELOW_PX, 50);
    const fits = Math.min(width_px / (right - left + 2 * MARGIN_M), height_px / (high - low + 2 * MARGIN_M));
    const px_per_m = Math.max(least, Math.min(most, fits));
    return { x_m: (left + right) / 2, y_m: (low + high) / 2 + (above_px - BELOW_PX) / 2 / px_per_m, px_per_m };
  }

  /** The corners of where the robot has been, as well as it is known. @returns {Point[]} */
  #trailCorners() {
    const { truth, estimated } = this.#store.trails;
    let [left, right, low, high] = [Infinity, -Infinity, Infinity, -Infinity];
    for (const [x, y] of truth.length > 0 ? truth : estimated) {
      [left, right, low, high] = [Math.min(left, x), Math.max(right, x), Math.min(low, y), Math.max(high, y)];
    }
    return left > right ? [] : [[left, low], [right, high]];
  }

  /** @param {number} factor @param {Point | null} about Stays where it is [px]; null: the middle. */
  #zoom(factor, about = null) {
    const view = this.#view ?? this.#fitted();
    const fixed = about && this.#toWorld(about);
    const px_per_m = Math.min(2_000, Math.max(5, view.px_per_m * factor));
    this.#view = { ...view, px_per_m };
    if (fixed && about) {
      const [x_m, y_m] = this.#toWorld(about);
      this.#view = { x_m: view.x_m + fixed[0] - x_m, y_m: view.y_m + fixed[1] - y_m, px_per_m };
    }
    this.#redraw();
  }

  /** @param {number} dx_px @param {number} dy_px */
  #pan(dx_px, dy_px) {
    const view = this.#view ?? this.#fitted();
    this.#view = { ...view, x_m: view.x_m - dx_px / view.px_per_m, y_m: view.y_m + dy_px / view.px_per_m };
    this.#redraw();
  }

  #makeNavigable() {
    const canvas = this.#canvas;
    canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      this.#zoom(event.deltaY > 0 ? 1 / ZOOM_STEP : ZOOM_STEP, [event.offsetX, event.offsetY]);
    }, { passive: false });
    /** @type {Record<string, () => void>} */
    const keys = {
      '+': () => this.#zoom(ZOOM_STEP),
      '-': () => this.#zoom(1 / ZOOM_STEP),
      0: () => this.fit(),
      ArrowLeft: () => this.#pan(KEY_PAN_PX, 0),
      ArrowRight: () => this.#pan(-KEY_PAN_PX, 0),
      ArrowUp: () => this.#pan(0, KEY_PAN_PX),
      ArrowDown: () => this.#pan(0, -KEY_PAN_PX),
      Enter: () => !this.#tool && this.#pick?.(this.#fromOrigin(this.#toWorld(this.#middle()))),
    };
    canvas.addEventListener('keydown', (event) => {
      if (this.#tool?.key(event)) return event.preventDefault();
      const act = keys[event.key];
      if (!act || event.defaultPrevented) return;
      event.preventDefault();
      act();
    });
    for (const type of ['focus', 'blur']) canvas.addEventListener(type, () => this.#redraw());
    this.#followButton.addEventListener('click', () => this.fit(this.#followButton.getAttribute('aria-pressed') !== 'true'));
    element('zoom-in', HTMLButtonElement).addEventListener('click', () => this.#zoom(ZOOM_STEP));
    element('zoom-out', HTMLButtonElement).addEventListener('click', () => this.#zoom(1 / ZOOM_STEP));
    // One finger drags as a mouse does.
    watchFingers(canvas, () => {}, (factor, { x, y }) => this.#zoom(factor, [x, y]));
  }

  /** The canvas's middle, where Enter picks a place [px]. @returns {Point} */
  #middle() {
    const [width, height] = this.#sketch.size;
    return [width / 2, height / 2];
  }

  /** What a press there would hold. @param {Point} pixel @param {number} reach_px @returns {Held | null} */
  #under(pixel, reach_px) {
    const scene = this.#sketch.scene;
    if (this.#tool || this.#store.playhead_s !== Infinity) return null;
    const [at, reach_m] = [this.#toWorld(pixel), reach_px / (this.#view ?? this.#fitted()).px_per_m];
    const goal = this.#pick && !this.#planning && this.#task?.goal;
    return take(this.#store, this.hand && scene, goal ? place(this.#drivenFrame(), goal) : null, at, reach_m);
  }

  /** @param {Point} at @param {boolean} turns */
  #carry(at, turns) {
    const hand = this.#hand;
    if (!hand) return;
    hand.held.carry(at, turns);
    this.#redraw();
    if (performance.now() - hand.sent_ms < HAND_MS) return;
    hand.sent_ms = performance.now();
    this.#put(hand.held);
  }

  /** @param {Held} held */
  #put(held) {
    const line = held.line();
    if (line !== null) this.hand?.(line);
  }

  #makePickable() {
    const canvas = this.#canvas;
    /** Where the button went down, until it has moved too far for a click [px]. @type {Point | null} */
    let pressed = null;
    /** The tool holds something. */
    let held = false;
    const release = () => {
      if (this.#hand && !pressed) {
        this.#put(this.#hand.held);
        if (this.#hand.held.goal) this.#pick?.(this.#fromOrigin(this.#hand.held.goal));
      }
      if (this.#hand) this.#view = this.#hand.view;
      this.#hand = null;
      if (held) this.#tool?.release();
      held = false;
      pressed = null;
    };
    canvas.addEventListener('pointerdown', (event) => {
      canvas.setPointerCapture(event.pointerId);
      // A second finger zooms.
      if (!event.isPrimary) return release();
      pressed = event.button === 0 ? [event.offsetX, event.offsetY] : null;
      const reach_px = event.pointerType === 'touch' ? REACH_PX.touch : REACH_PX.mouse;
      const under = pressed && this.#under(pressed, reach_px);
      if (under) {
        this.#hand = { held: under, sent_ms: -Infinity, view: this.#view };
        this.#view ??= this.#fitted();
      }
      held = pressed !== null && (this.#tool?.press(this.#toWorld(pressed), reach_px / (this.#view ?? this.#fitted()).px_per_m) ?? false);
    });
    canvas.addEventListener('pointermove', (event) => {
      this.#pointer = [event.offsetX, event.offsetY];
      this.#redraw();
      if (!canvas.hasPointerCapture(event.pointerId)) canvas.classList.toggle('holdable', this.#under(this.#pointer, REACH_PX.mouse) !== null);
      if (!canvas.hasPointerCapture(event.pointerId) || !event.isPrimary) return;
      if (pressed && Math.hypot(event.offsetX - pressed[0], event.offsetY - pressed[1]) <= CLICK_PX) return;
      pressed = null;
      if (this.#hand) return this.#carry(this.#toWorld([event.offsetX, event.offsetY]), event.shiftKey);
      if (held) return this.#tool?.drag(this.#toWorld([event.offsetX, event.offsetY]));
      this.#pan(event.movementX, event.movementY);
    });
    canvas.addEventListener('pointerup', () => {
      if (pressed && this.#pick && !this.#tool) this.#pick(this.#fromOrigin(this.#toWorld(pressed)));
      release();
    });
    canvas.addEventListener('pointercancel', release);
    canvas.addEventListener('pointerleave', () => {
      this.#pointer = null;
      this.#redraw();
    });
  }
}
