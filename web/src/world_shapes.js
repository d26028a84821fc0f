// @ts-check
/**
 * The shapes of a world that is edited: where they are, what a pointer meets, and the world after a change. A world is what
 * its file holds; keys that are not known here stay in it. Nothing here changes a world in place.
 */
import { compose, inverse, place } from './geometry.js';

/** @typedef {[number, number]} Point World frame [m]. */
/** @typedef {{from_m: Point, to_m: Point, thickness_m?: number}} Wall */
/** @typedef {{centre_m: Point, size_m: Point, angle_deg?: number}} Box */
/** @typedef {{at_m: Point, height_m?: number, lumen?: number}} Lamp */
/** @typedef {{x_m?: number, y_m?: number, heading_deg?: number}} Start */
/**
 * @typedef {object} World
 * @property {string} [title]
 * @property {{from_m?: Point, to_m?: Point, walled?: boolean}} [arena]
 * @property {Wall[]} [wall]
 * @property {Box[]} [box]
 * @property {Lamp[]} [lamp]
 * @property {Start} [start]
 * @property {Point} [goal_m]
 */
/** A shape of it; `arena` is the world itself. @typedef {{kind: 'wall' | 'box' | 'lamp' | 'start' | 'goal' | 'arena', index: number}} Item */
/** Of these a world may have several. @typedef {'wall' | 'box' | 'lamp'} Many */
/** What is held of a shape: all of it, an end, a corner (which signs of x and y), or what turns it. @typedef {'all' | 'from' | 'to' | 'turn' | Point} Grip */
/** @typedef {{step_m: number, step_deg: number}} Snap 0: to a millimetre, to a tenth of a degree. */

/** @type {Item} */
export const ARENA = { kind: 'arena', index: 0 };
/** Not from `units.js`, which knows the page's language. */
const DEG_PER_RAD = 180 / Math.PI;
/** What turns a shape is so far from its edge [m]. */
const TURN_M = 0.12;
/** Smallest side that a pointer makes [m]. */
const LEAST_M = 0.01;
/** @type {Point[]} */
const CORNERS = [[1, 1], [-1, 1], [-1, -1], [1, -1]];
/** The arena of a file that has none [m]. */
const USUAL_M = /** @type {const} */ ([[-2, -2], [2, 2]]);

/** @param {number} value @param {number} step 0: no grid */
export const snapped = (value, step) => Number((step > 0 ? Math.round(value / step) * step : value).toFixed(3));

/** @param {Point} at @param {Snap} snap @returns {Point} */
const toGrid = ([x, y], { step_m }) => [snapped(x, step_m), snapped(y, step_m)];

/** Within a half turn to both sides. @param {number} angle_rad @param {Snap} snap */
const toAngle = (angle_rad, { step_deg }) => snapped(angle_rad * DEG_PER_RAD, step_deg || 0.1);

/** @param {World} world @returns {[Point, Point]} */
export function arenaOf({ arena }) {
  const [from, to] = USUAL_M;
  return [arena?.from_m ?? [...from], arena?.to_m ?? [...to]];
}

/** @param {Box} box */
const frameOf = ({ centre_m: [x_m, y_m], angle_deg = 0 }) => ({ x_m, y_m, heading_rad: angle_deg / DEG_PER_RAD });

/** @param {Start | undefined} start */
export const poseOf = (start) => ({ x_m: start?.x_m ?? 0, y_m: start?.y_m ?? 0, heading_rad: (start?.heading_deg ?? 0) / DEG_PER_RAD });

/** @param {Box} box @returns {Point[]} */
function cornersOf(box) {
  const [length, width] = box.size_m;
  return CORNERS.map(([sx, sy]) => place(frameOf(box), [(sx * length) / 2, (sy * width) / 2]));
}

/** A thick wall has corners, a thin one is a line. @param {Wall} wall @returns {Point[]} */
function cornersOfWall({ from_m, to_m, thickness_m = 0 }) {
  if (thickness_m === 0) return [from_m, to_m];
  const length = Math.hypot(to_m[0] - from_m[0], to_m[1] - from_m[1]) || 1;
  const [nx, ny] = [-((to_m[1] - from_m[1]) / length) * (thickness_m / 2), ((to_m[0] - from_m[0]) / length) * (thickness_m / 2)];
  return [[from_m[0] + nx, from_m[1] + ny], [to_m[0] + nx, to_m[1] + ny], [to_m[0] - nx, to_m[1] - ny], [from_m[0] - nx, from_m[1] - ny]];
}

/** The lamps with what they are where they do not say it: a bulb that replaces one of 60 W, on the floor. @param {World} world */
export const lampsOf = ({ lamp = [] }) => lamp.map(({ at_m, height_m = 0.1, lumen = 806 }) => ({ at_m, height_m, lumen }));

/** Every wall and box with its corners, and the sides of a walled arena. @param {World} world */
export function outlines(world) {
  const [[x0, y0], [x1, y1]] = arenaOf(world);
  /** @type {{item: Item, corners_m: Point[], closed: boolean}[]} */
  const sides = world.arena?.walled ? [{ item: ARENA, corners_m: [[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]], closed: false }] : [];
  const walls = (world.wall ?? []).map((wall, index) => {
    const corners_m = cornersOfWall(wall);
    return { item: /** @type {Item} */ ({ kind: 'wall', index }), corners_m, closed: corners_m.length > 2 };
  });
  const boxes = (world.box ?? []).map((box, index) => ({ item: /** @type {Item} */ ({ kind: 'box', index }), corners_m: cornersOf(box), closed: true }));
  return [...sides, ...walls, ...boxes];
}

/** All shapes that can be chosen. @param {World} world @returns {Item[]} */
export function items(world) {
  /** @param {Many} kind @returns {Item[]} */
  const all = (kind) => (world[kind] ?? []).map((_shape, index) => ({ kind, index }));
  return [ARENA, ...all('box'), ...all('wall'), ...all('lamp'), { kind: 'start', index: 0 }, ...(world.goal_m ? [/** @type {Item} */ ({ kind: 'goal', index: 0 })] : [])];
}

/** Whether it is there. @param {World} world @param {Item} item */
export const has = (world, item) => items(world).some((each) => sameItem(each, item));

/** @param {Item} one @param {Item} other */
export const sameItem = (one, other) => one.kind === other.kind && one.index === other.index;

/** Where a shape can be held besides as a whole. @param {World} world @param {Item} item @returns {{grip: Grip, at: Point}[]} */
export function grips(world, { kind, index }) {
  const wall = world.wall?.[index];
  if (kind === 'wall' && wall) return [{ grip: 'from', at: wall.from_m }, { grip: 'to', at: wall.to_m }];
  const box = world.box?.[index];
  if (kind === 'box' && box) {
    const corners = cornersOf(box);
    return [...CORNERS.map((grip, corner) => ({ grip, at: corners[corner] ?? box.centre_m })), { grip: 'turn', at: place(frameOf(box), [box.size_m[0] / 2 + TURN_M, 0]) }];
  }
  return kind === 'start' ? [{ grip: 'turn', at: place(poseOf(world.start), [2 * TURN_M, 0]) }] : [];
}

/**
 * What is at a place: a grip of the chosen shape first, then the nearest shape.
 * @param {World} world
 * @param {Item} chosen
 * @param {Point} at
 * @param {number} reach_m
 * @returns {{item: Item, grip: Grip} | null}
 */
export function met(world, chosen, at, reach_m) {
  const near = (/** @type {Point} */ [x, y]) => Math.hypot(x - at[0], y - at[1]) <= reach_m;
  const held = grips(world, chosen).find((each) => near(each.at));
  if (held) return { item: chosen, grip: held.grip };
  const { x_m, y_m } = poseOf(world.start);
  const lamp = (world.lamp ?? []).findLastIndex(({ at_m }) => near(at_m));
  if (lamp >= 0) return { item: { kind: 'lamp', index: lamp }, grip: 'all' };
  if (world.goal_m && near(world.goal_m)) return { item: { kind: 'goal', index: 0 }, grip: 'all' };
  if (Math.hypot(x_m - at[0], y_m - at[1]) <= Math.max(reach_m, 0.1)) return { item: { kind: 'start', index: 0 }, grip: 'all' };
  const shape = outlines(world).reverse().find(({ item, corners_m, closed }) => item.kind !== 'arena' && isAt(corners_m, closed, at, reach_m));
  return shape ? { item: shape.item, grip: 'all' } : null;
}

/** Whether an outline is at a place. @param {Point[]} corners @param {boolean} closed @param {Point} at @param {number} reach_m */
export function isAt(corners, closed, at, reach_m) {
  const sides = corners.map((corner, index) => /** @type {[Point, Point]} */ ([corner, corners[(index + 1) % corners.length]]));
  if ((closed ? sides : sides.slice(0, -1)).some(([from, to]) => distance(from, to, at) <= reach_m)) return true;
  // Inside: on the same side of every edge.
  const turns = sides.map(([[x0, y0], [x1, y1]]) => Math.sign((x1 - x0) * (at[1] - y0) - (y1 - y0) * (at[0] - x0)));
  return closed && (turns.every((turn) => turn >= 0) || turns.every((turn) => turn <= 0));
}

/** From a line between two points. @param {Point} from @param {Point} to @param {Point} at */
function distance([x0, y0], [x1, y1], [x, y]) {
  const [dx, dy] = [x1 - x0, y1 - y0];
  const part = Math.min(1, Math.max(0, ((x - x0) * dx + (y - y0) * dy) / (dx * dx + dy * dy || 1)));
  return Math.hypot(x - x0 - part * dx, y - y0 - part * dy);
}

/** The middle of a shape, or its first end: what is on the grid when it is moved. @param {World} world @param {Item} item @returns {Point} */
export function anchor(world, { kind, index }) {
  const { x_m, y_m } = poseOf(world.start);
  if (kind === 'wall') return world.wall?.[index]?.from_m ?? [0, 0];
  if (kind === 'box') return world.box?.[index]?.centre_m ?? [0, 0];
  if (kind === 'lamp') return world.lamp?.[index]?.at_m ?? [0, 0];
  return kind === 'goal' ? world.goal_m ?? [0, 0] : [x_m, y_m];
}

/** The world with these keys of a shape changed. @param {World} world @param {Item} item @param {Record<string, unknown>} keys @returns {World} */
export function changed(world, { kind, index }, keys) {
  if (kind === 'goal') return { ...world, ...keys };
  if (kind === 'wall' || kind === 'box' || kind === 'lamp') return { ...world, [kind]: (world[kind] ?? []).map((shape, each) => (each === index ? { ...shape, ...keys } : shape)) };
  return { ...world, [kind]: { ...world[kind], ...keys } };
}

/** The world with a shape's anchor at a place. @param {World} world @param {Item} item @param {Point} at @param {Snap} snap @returns {World} */
export function moved(world, item, at, snap) {
  const [x_m, y_m] = toGrid(at, snap);
  const wall = world.wall?.[item.index];
  if (item.kind === 'wall' && wall) {
    const [dx, dy] = [x_m - wall.from_m[0], y_m - wall.from_m[1]];
    return changed(world, item, { from_m: [x_m, y_m], to_m: [snapped(wall.to_m[0] + dx, 0), snapped(wall.to_m[1] + dy, 0)] });
  }
  if (item.kind === 'box') return changed(world, item, { centre_m: [x_m, y_m] });
  if (item.kind === 'lamp') return changed(world, item, { at_m: [x_m, y_m] });
  if (item.kind === 'goal') return changed(world, item, { goal_m: [x_m, y_m] });
  return item.kind === 'start' ? changed(world, item, { x_m, y_m }) : world;
}

/** The world with a grip of a shape at a place. @param {World} world @param {Item} item @param {Grip} grip @param {Point} at @param {Snap} snap @returns {World} */
export function pulled(world, item, grip, at, snap) {
  if (grip === 'all') return moved(world, item, at, snap);
  if (grip === 'from' || grip === 'to') return changed(world, item, { [`${grip}_m`]: toGrid(at, snap) });
  const [x, y] = anchor(world, item);
  if (grip === 'turn') return changed(world, item, { [item.kind === 'box' ? 'angle_deg' : 'heading_deg']: toAngle(Math.atan2(at[1] - y, at[0] - x), snap) });
  const box = world.box?.[item.index];
  return box ? changed(world, item, resized(box, grip, at, snap)) : world;
}

/** A box with a corner at a place; the corner across stays. @param {Box} box @param {Point} corner @param {Point} at @param {Snap} snap */
function resized(box, [sx, sy], at, snap) {
  const frame = frameOf(box);
  const across = place(frame, [(-sx * box.size_m[0]) / 2, (-sy * box.size_m[1]) / 2]);
  const from = { ...frame, x_m: across[0], y_m: across[1] };
  const local = compose(inverse(from), { x_m: at[0], y_m: at[1], heading_rad: 0 });
  /** @type {Point} */
  const size_m = [Math.max(LEAST_M, snapped(sx * local.x_m, snap.step_m)), Math.max(LEAST_M, snapped(sy * local.y_m, snap.step_m))];
  const [x, y] = place(from, [(sx * size_m[0]) / 2, (sy * size_m[1]) / 2]);
  return { size_m, centre_m: [snapped(x, 0), snapped(y, 0)] };
}

/** The world with a shape turned by an angle. @param {World} world @param {Item} item @param {number} by_deg @returns {World} */
export function turned(world, item, by_deg) {
  const key = item.kind === 'box' ? 'angle_deg' : item.kind === 'start' ? 'heading_deg' : null;
  if (key === null) return world;
  const now_deg = (item.kind === 'box' ? world.box?.[item.index]?.angle_deg : world.start?.heading_deg) ?? 0;
  const next_deg = now_deg + by_deg;
  return changed(world, item, { [key]: snapped(next_deg > 180 ? next_deg - 360 : next_deg <= -180 ? next_deg + 360 : next_deg, 0) });
}

/** The world with a new shape at a place, and the shape. @param {World} world @param {Many | 'goal'} kind @param {Point} at @param {Snap} snap @returns {[World, Item]} */
export function added(world, kind, at, snap) {
  const [x, y] = toGrid(at, snap);
  if (kind === 'goal') return [{ ...world, goal_m: [x, y] }, { kind, index: 0 }];
  const index = world[kind]?.length ?? 0;
  const shape = { wall: { from_m: [x, y], to_m: [snapped(x + 0.5, 0), y] }, box: { centre_m: [x, y], size_m: [0.3, 0.3], angle_deg: 0 }, lamp: { at_m: [x, y] } }[kind];
  return [{ ...world, [kind]: [...(world[kind] ?? []), shape] }, { kind, index }];
}

/** The world without a shape; the start stays. @param {World} world @param {Item} item @returns {World} */
export function without(world, { kind, index }) {
  if (kind === 'goal') {
    const { goal_m: _gone, ...rest } = world;
    return rest;
  }
  return kind === 'wall' || kind === 'box' || kind === 'lamp' ? { ...world, [kind]: (world[kind] ?? []).filter((_shape, each) => each !== index) } : world;
}

/** A world with its past: changes can be taken back. */
export class Draft {
  /** @type {World[]} */
  #past = [];
  /** @type {World[]} */
  #future = [];
  /** Changes of the same name one after the other are one. @type {string | null} */
  #last = null;

  /** @param {World} world */
  constructor(world) {
    this.world = world;
  }

  get canUndo() {
    return this.#past.length > 0;
  }

  get canRedo() {
    return this.#future.length > 0;
  }

  /** @param {World} next @param {string | null} [name] */
  change(next, name = null) {
    if (JSON.stringify(next) === JSON.stringify(this.world)) return;
    if (name === null || name !== this.#last) this.#past.push(this.world);
    this.#last = name;
    this.#future = [];
    this.world = next;
  }

  /** The next change is one of its own. */
  settle() {
    this.#last = null;
  }

  undo() {
    this.#swap(this.#past, this.#future);
  }

  redo() {
    this.#swap(this.#future, this.#past);
  }

  /** @param {World[]} from @param {World[]} to */
  #swap(from, to) {
    const next = from.pop();
    if (!next) return;
    to.push(this.world);
    this.world = next;
    this.settle();
  }
}
