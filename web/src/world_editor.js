// @ts-check
/**
 * The editor of the world on the map: its panel takes the place of the commands, its shapes are drawn and dragged on the map.
 * The session checks each change as it checks a file, writes the file, and starts the robot again in the edited world.
 */
import { inWorld } from './movers.js';
import { check, decimal, read, setLimits, write } from './decimal.js';
import { complaint, fileButton, saveFile } from './dialog.js';
import { clickable, create, element, setText } from './dom.js';
import { said, t } from './text.js';
import { colours } from './theme.js';
import { ARENA, Draft, added, anchor, arenaOf, changed, grips, has, items, lampsOf, met, moved, outlines, poseOf, pulled, sameItem, turned, without } from './world_shapes.js';

/** @typedef {import('./types.js').EditedWorld} EditedWorld */
/** @typedef {import('./panel.js').Send} Send */
/** @typedef {import('./map.js').WorldMap} WorldMap */
/** @typedef {import('./world_shapes.js').World} World */
/** @typedef {import('./world_shapes.js').Item} Item */
/** @typedef {import('./world_shapes.js').Grip} Grip */
/** @typedef {[number, number]} Point World frame [m]. */
/** A field of a shape: its name, its unit, its value, and what a new value changes. @typedef {{name: string, unit: string, value: number, keys: (value: number) => Record<string, unknown>}} Field */

/** Steps of the grid [cm]; 0: none. */
const STEPS_CM = [10, 5, 1, 0];
/** With a grid, angles are its multiples [deg]; the keys turn by as much. */
const STEP_DEG = 5;
/** Without a grid the keys move by this much [m]. */
const FINE_M = 0.001;
/** A change is checked when no other has followed for so long [ms]. */
const PAUSE_MS = 150;
const GRIP_PX = 4.5;

export class WorldEditor {
  #send;
  #map;
  #root = element('editor', HTMLElement);
  #open = element('edit-world', HTMLButtonElement);
  #undo = button(t('Undo'), t('Take the last change back (Ctrl+Z)'), () => this.#step('undo'));
  #redo = button(t('Redo'), t('Make the change again (Ctrl+Y)'), () => this.#step('redo'));
  #remove = button(t('Delete'), t('Delete what is selected (Delete)'), () => this.#delete());
  #goal = button(t('+ Goal'), t('Add a goal in the middle of the map'), () => this.#add('goal'));
  #grid = create('select', { id: 'editor-grid', title: t('What is moved and resized snaps to this grid; angles to 5°') }, ...STEPS_CM.map((cm) => create('option', { value: String(cm), textContent: cm === 0 ? t('none') : `${cm} cm` })));
  #chosen = create('select', { id: 'editor-item' });
  #fields = create('div', { id: 'editor-fields', className: 'row' });
  #problem = complaint();
  #drive = button(t('Drive here'), t('Start the robot again in this world, switched off'), () => this.#ask('drive'));
  /** @type {Draft | null} */
  #draft = null;
  #item = ARENA;
  /** What the pointer holds, and how far from the anchor. @type {{grip: Grip, off: Point} | null} */
  #held = null;
  #ticket = Math.floor(Math.random() * 2 ** 30);
  /** What to do with the answer to the last order. @type {(world: EditedWorld) => void} */
  #answered = () => {};
  #waiting = 0;

  /** @param {Send} send @param {WorldMap} map */
  constructor(send, map) {
    this.#send = send;
    this.#map = map;
    this.#open.addEventListener('click', () => (this.#draft ? this.close() : this.#ask('show')));
    this.#drive.classList.add('go');
    this.#problem.id = 'editor-problem';
    this.#grid.value = '5';
    this.#chosen.addEventListener('change', () => {
      const [kind, index] = this.#chosen.value.split(' ');
      this.#select({ kind: /** @type {Item['kind']} */ (kind), index: Number(index) });
    });
    this.#root.append(
      create('div', { className: 'row' }, this.#undo, this.#redo, button(t('+ Wall'), t('Add a wall in the middle of the map'), () => this.#add('wall')), button(t('+ Box'), t('Add a box in the middle of the map'), () => this.#add('box')), button(t('+ Lamp'), t('Add a lamp in the middle of the map'), () => this.#add('lamp')), this.#goal, this.#remove),
      create('div', { className: 'row' }, create('label', {}, `${t('selected')} `, this.#chosen), create('label', {}, `${t('grid')} `, this.#grid)),
      this.#fields,
      this.#problem,
      create('div', { className: 'row' }, this.#drive, button(t('Save file'), t('The world as a file, for `rumbo run SCENARIO --world FILE` too'), () => this.#ask('save')),
        fileButton(t('Open file…'), '.toml', async (file) => this.#ask('open', await file.text())), button(t('Close'), t('Leave the editor; the robot drives on in its world'), () => this.close())),
      create('p', { className: 'hint', textContent: t('Drag shapes and their handles on the map. Keys on the map: arrows move, [ and ] turn, Delete, Ctrl+Z.') }),
    );
  }

  /** The editor has no place where there is nothing to edit. @param {import('./types.js').Scene | null} scene */
  setScene(scene) {
    if (!scene) this.close();
  }

  /** An answer of the session. @param {EditedWorld} world */
  receive(world) {
    if (world.ticket === this.#ticket) this.#answered(world);
  }

  close() {
    if (!this.#draft) return;
    clearTimeout(this.#waiting);
    this.#draft = null;
    this.#held = null;
    this.#answered = () => {};
    document.body.classList.remove('editing');
    this.#root.hidden = true;
    this.#map.setTool(null);
    this.#open.setAttribute('aria-pressed', 'false');
    this.#open.focus();
  }

  /** @param {'show' | 'check' | 'drive' | 'save' | 'open'} what @param {string} [file] */
  #ask(what, file) {
    clearTimeout(this.#waiting);
    this.#ticket += 1;
    this.#answered = (world) => this.#take(what, world);
    const text = what === 'show' ? '' : file ?? JSON.stringify(this.#draft?.world);
    this.#send({ type: 'world', ticket: this.#ticket, act: what === 'show' || what === 'drive' ? what : 'check', text });
  }

  /** @param {'show' | 'check' | 'drive' | 'save' | 'open'} what @param {EditedWorld} world */
  #take(what, { model, toml, problem, driven }) {
    if (driven) return this.close();
    this.#showProblem(problem);
    if (what === 'show' && model) this.#begin(model);
    else if (what === 'open' && model) this.#change(model);
    else if (what === 'save' && toml !== '') saveFile(`${fileName(this.#draft?.world.title)}.toml`, new Blob([toml], { type: 'application/toml' }));
  }

  /** @param {string | null} problem */
  #showProblem(problem) {
    setText(this.#problem, said(problem ?? ''));
    this.#drive.disabled = problem !== null;
  }

  /** @param {World} world */
  #begin(world) {
    this.#draft = new Draft(world);
    this.#item = ARENA;
    document.body.classList.add('editing');
    this.#root.hidden = false;
    this.#open.setAttribute('aria-pressed', 'true');
    this.#map.setTool(this);
    this.#show();
    this.#map.focus();
  }

  /** @param {World} world @param {string | null} [name] what is one change with the next of this name */
  #change(world, name = null) {
    if (!this.#draft) return;
    this.#draft.change(world, name);
    this.#edited();
  }

  /** @param {'undo' | 'redo'} way */
  #step(way) {
    this.#draft?.[way]();
    this.#edited();
  }

  #edited() {
    if (!this.#draft) return;
    if (!has(this.#draft.world, this.#item)) this.#item = ARENA;
    clearTimeout(this.#waiting);
    this.#waiting = window.setTimeout(() => this.#ask('check'), PAUSE_MS);
    this.#show();
  }

  /** @param {Item} item */
  #select(item) {
    this.#item = item;
    this.#draft?.settle();
    this.#show();
  }

  /** @param {import('./world_shapes.js').Many | 'goal'} kind */
  #add(kind) {
    if (!this.#draft) return;
    const [world, item] = added(this.#draft.world, kind, this.#map.middle(), this.#snap);
    this.#item = item;
    this.#change(world);
  }

  #delete() {
    if (this.#draft) this.#change(without(this.#draft.world, this.#item));
  }

  get #snap() {
    const cm = Number(this.#grid.value);
    return { step_m: cm / 100, step_deg: cm === 0 ? 0 : STEP_DEG };
  }

  #show() {
    const draft = this.#draft;
    if (!draft) return;
    const { world } = draft;
    this.#undo.disabled = !draft.canUndo;
    this.#redo.disabled = !draft.canRedo;
    this.#remove.disabled = ['arena', 'start'].includes(this.#item.kind);
    this.#goal.disabled = world.goal_m !== undefined;
    this.#chosen.replaceChildren(...items(world).map((item) => create('option', { value: `${item.kind} ${item.index}`, textContent: nameOf(item) })));
    this.#chosen.value = `${this.#item.kind} ${this.#item.index}`;
    this.#showFields(world);
    this.#map.redraw();
  }

  /** The fields of the chosen shape; those that are there stay, so that one who types keeps the cursor. @param {World} world */
  #showFields(world) {
    const fields = fieldsOf(world, this.#item);
    const shape = `${this.#item.kind} ${this.#item.index}`;
    if (this.#fields.dataset['shape'] !== shape) {
      this.#fields.dataset['shape'] = shape;
      this.#fields.replaceChildren(...fields.map(({ name, unit }, index) => {
        const input = decimal(`editor-${index}`);
        input.addEventListener('input', () => this.#type(index, input));
        input.addEventListener('change', () => this.#draft?.settle());
        return create('label', {}, `${name} `, input, ` ${unit}`);
      }), ...(this.#item.kind === 'arena' ? this.#arenaFields() : []));
    }
    for (const [index, input] of this.#fields.querySelectorAll('input.decimal').entries()) {
      const field = fields[index];
      if (!field || !(input instanceof HTMLInputElement)) continue;
      setLimits(input, -1e3, field.unit === 'lm' ? 2e4 : 1e3);
      if (read(input) !== field.value) write(input, field.value);
    }
    const [title, walled] = ['editor-title', 'editor-walled'].map((id) => document.getElementById(id));
    if (title instanceof HTMLInputElement && title !== document.activeElement) title.value = world.title ?? '';
    if (walled instanceof HTMLInputElement) walled.checked = world.arena?.walled ?? false;
  }

  #arenaFields() {
    const title = create('input', { type: 'text', id: 'editor-title', maxLength: 80 });
    title.addEventListener('input', () => this.#draft && this.#change({ ...this.#draft.world, title: title.value }, 'title'));
    const walled = create('input', { type: 'checkbox', id: 'editor-walled' });
    walled.addEventListener('change', () => this.#draft && this.#change(changed(this.#draft.world, ARENA, { walled: walled.checked })));
    return [create('label', {}, walled, ` ${t('walls around it')}`), create('label', {}, `${t('title')} `, title)];
  }

  /** A number was typed into a field. @param {number} index @param {HTMLInputElement} input */
  #type(index, input) {
    const field = this.#draft && fieldsOf(this.#draft.world, this.#item)[index];
    const value = read(input);
    check(input);
    if (this.#draft && field && input.validity.valid && !Number.isNaN(value)) this.#change(changed(this.#draft.world, this.#item, field.keys(value)), `field ${index}`);
  }

  // What the map asks of its tool.

  /** What is to be in sight [m]. @returns {Point[]} */
  get bounds() {
    return this.#draft ? [...arenaOf(this.#draft.world), ...outlines(this.#draft.world).flatMap(({ corners_m }) => corners_m)] : [];
  }

  /** Takes what is at a place in hand; false: there is nothing. @param {Point} at @param {number} reach_m */
  press(at, reach_m) {
    if (!this.#draft) return false;
    const found = met(this.#draft.world, this.#item, at, reach_m);
    this.#select(found?.item ?? ARENA);
    if (!found) return false;
    const from = anchor(this.#draft.world, found.item);
    this.#held = { grip: found.grip, off: found.grip === 'all' ? [at[0] - from[0], at[1] - from[1]] : [0, 0] };
    return true;
  }

  /** @param {Point} at */
  drag(at) {
    if (!this.#held || !this.#draft) return;
    const { grip, off } = this.#held;
    this.#change(pulled(this.#draft.world, this.#item, grip, [at[0] - off[0], at[1] - off[1]], this.#snap), 'drag');
  }

  release() {
    this.#held = null;
    this.#draft?.settle();
  }

  /** Whether a key was for it. @param {KeyboardEvent} event */
  key(event) {
    if (!this.#draft) return false;
    const { step_m, step_deg } = this.#snap;
    const by_m = step_m || FINE_M;
    const [x, y] = anchor(this.#draft.world, this.#item);
    const move = (/** @type {number} */ dx, /** @type {number} */ dy) => this.#draft && this.#change(moved(this.#draft.world, this.#item, [x + dx * by_m, y + dy * by_m], { step_m: 0, step_deg }), 'key');
    const turn = (/** @type {number} */ sign) => this.#draft && this.#change(turned(this.#draft.world, this.#item, sign * (step_deg || 1)), 'key');
    /** @type {Record<string, () => unknown>} */
    const keys = event.ctrlKey || event.metaKey
      ? { z: () => this.#step(event.shiftKey ? 'redo' : 'undo'), Z: () => this.#step('redo'), y: () => this.#step('redo') }
      : {
        Delete: () => this.#delete(), Backspace: () => this.#delete(), '[': () => turn(1), ']': () => turn(-1), Escape: () => this.#select(ARENA),
        ...(this.#item.kind === 'arena' ? {} : { ArrowLeft: () => move(-1, 0), ArrowRight: () => move(1, 0), ArrowUp: () => move(0, 1), ArrowDown: () => move(0, -1) }),
      };
    const act = keys[event.key];
    act?.();
    return act !== undefined;
  }

  /** @param {import('./sketch.js').Sketch} sketch @param {number} px */
  draw(sketch, px) {
    if (!this.#draft) return;
    const { world } = this.#draft;
    const { context } = sketch;
    sketch.drawArena(...arenaOf(world), px);
    sketch.drawLamps(px, lampsOf(world));
    sketch.drawOutlines(px, outlines(world));
    sketch.drawOutlines(px, inWorld(sketch.scene && { ...sketch.scene, obstacles: [] }, { placeOf: () => null }, 0));
    const start = poseOf(world.start);
    sketch.drawRobot(start, px, 'real', false);
    if (world.goal_m) sketch.drawGoal(world.goal_m, [start.x_m, start.y_m], px);
    const mine = outlines(world).find(({ item }) => sameItem(item, this.#item) && item.kind !== 'arena');
    if (mine) sketch.drawOutlines(px, [mine], colours.left);
    context.strokeStyle = colours.left;
    context.fillStyle = colours.panel;
    context.lineWidth = 2 * px;
    const marks = this.#item.kind === 'arena' ? [] : [...grips(world, this.#item), ...(mine ? [] : [{ grip: /** @type {Grip} */ ('all'), at: anchor(world, this.#item) }])];
    for (const { grip, at: [x, y] } of marks) {
      const size = GRIP_PX * px;
      context.beginPath();
      if (grip === 'turn') context.arc(x, y, 1.2 * size, 0, 2 * Math.PI);
      else context.rect(x - size, y - size, 2 * size, 2 * size);
      context.fill();
      context.stroke();
    }
  }
}

/** @param {string} text @param {string} title @param {() => void} act */
function button(text, title, act) {
  return clickable({ textContent: text, title }, act);
}

/** @param {Item} item */
function nameOf({ kind, index }) {
  if (kind === 'wall') return t('wall {}', index + 1);
  if (kind === 'box') return t('box {}', index + 1);
  if (kind === 'lamp') return t('lamp {}', index + 1);
  return kind === 'start' ? t('start') : kind === 'goal' ? t('goal') : t('the world');
}

/** The numbers of a shape. @param {World} world @param {Item} item @returns {Field[]} */
function fieldsOf(world, { kind, index }) {
  /** @param {string} name @param {string} key @param {number} value @param {string} [unit] @returns {Field} */
  const one = (name, key, value, unit = 'm') => ({ name, unit, value: short(value), keys: (next) => ({ [key]: next }) });
  /** @param {[string, string]} names @param {string} key @param {Point} at @returns {Field[]} */
  const two = ([first, second], key, [x, y]) => [
    { name: first, unit: '', value: short(x), keys: (next) => ({ [key]: [next, y] }) },
    { name: second, unit: 'm', value: short(y), keys: (next) => ({ [key]: [x, next] }) },
  ];
  const wall = world.wall?.[index];
  if (kind === 'wall' && wall) return [...two([t('from x'), 'y'], 'from_m', wall.from_m), ...two([t('to x'), 'y'], 'to_m', wall.to_m), one(t('thickness'), 'thickness_m', wall.thickness_m ?? 0)];
  const box = world.box?.[index];
  if (kind === 'box' && box) return [...two([t('middle x'), 'y'], 'centre_m', box.centre_m), ...two([t('length'), t('width')], 'size_m', box.size_m), one(t('angle'), 'angle_deg', box.angle_deg ?? 0, '°')];
  const lamp = lampsOf(world)[index];
  if (kind === 'lamp' && lamp) return [...two(['x', 'y'], 'at_m', lamp.at_m), one(t('height'), 'height_m', lamp.height_m), one(t('luminous flux'), 'lumen', lamp.lumen, 'lm')];
  const { x_m = 0, y_m = 0, heading_deg = 0 } = world.start ?? {};
  if (kind === 'start') return [one('x', 'x_m', x_m), one('y', 'y_m', y_m), one(t('heading'), 'heading_deg', heading_deg, '°')];
  if (kind === 'goal' && world.goal_m) return two(['x', 'y'], 'goal_m', world.goal_m);
  const [from, to] = arenaOf(world);
  return [...two([t('from x'), 'y'], 'from_m', from), ...two([t('to x'), 'y'], 'to_m', to)];
}

/** As many digits as a field shows. @param {number} value */
const short = (value) => Number(value.toPrecision(6));

/** @param {string | undefined} title */
function fileName(title) {
  return (title ?? '').toLowerCase().replace(/[^a-z0-9]+/g, '_').replace(/^_+|_+$/g, '').slice(0, 40) || 'world';
}

