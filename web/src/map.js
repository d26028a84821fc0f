// @ts-check
/** The map: world, robot as it is and as it believes to be, trails, and the sonars' cones with their readings. */
import { colours, onThemeChange } from './theme.js';

/** @typedef {import('./types.js').Scene} Scene */
/** @typedef {import('./types.js').Cell} Cell */
/** @typedef {import('./store.js').Store} Store */
/** @typedef {import('./store.js').Pose} Pose */
/** @typedef {import('./theme.js').ColourName} ColourName */

/** Outline of a robot of which nothing is known [m]. */
const DEFAULT_FOOTPRINT = /** @type {[number, number][]} */ ([[0.1, 0.075], [-0.1, 0.075], [-0.1, -0.075], [0.1, -0.075]]);
const SONAR_COLOURS = /** @type {ColourName[]} */ (['left', 'right', 'front']);
/** Free space around what is to be seen [m]. */
const MARGIN_M = 0.25;
const ZOOM_STEP = 1.25;
const KEY_PAN_PX = 40;

export class WorldMap {
  #canvas;
  #context;
  #store;
  #redraw;
  /** @type {Scene | null} */
  #scene = null;
  /** Middle of the view [m] and its scale; null: everything fits. @type {{x_m: number, y_m: number, px_per_m: number} | null} */
  #view = null;
  servo_rad = 0;

  /**
   * @param {HTMLCanvasElement} canvas
   * @param {Store} store
   * @param {() => void} redraw asks for a frame
   */
  constructor(canvas, store, redraw) {
    this.#canvas = canvas;
    const context = canvas.getContext('2d');
    if (!context) throw new Error('the browser has no 2-D canvas');
    this.#context = context;
    this.#store = store;
    this.#redraw = redraw;
    new ResizeObserver(redraw).observe(canvas);
    onThemeChange(redraw);
    this.#makeNavigable();
  }

  /** @param {Scene | null} scene */
  setScene(scene) {
    this.#scene = scene;
    this.#view = null;
    this.#redraw();
  }

  draw() {
    const canvas = this.#canvas;
    const ratio = devicePixelRatio;
    const width = Math.round(canvas.clientWidth * ratio);
    const height = Math.round(canvas.clientHeight * ratio);
    if (canvas.width !== width || canvas.height !== height) {
      canvas.width = width;
      canvas.height = height;
    }
    const view = this.#view ?? this.#fitted();
    const scale = view.px_per_m * ratio;
    const context = this.#context;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, width, height);
    // From here on in metres, y up.
    context.setTransform(scale, 0, 0, -scale, width / 2 - view.x_m * scale, height / 2 + view.y_m * scale);
    const px = ratio / scale;
    this.#drawGrid(view, px);
    this.#drawWorld(px);
    this.#drawTrail(this.#store.trails.truth, colours.robot, 1.5 * px, this.#identity());
    this.#drawTrail(this.#store.trails.estimated, colours.dim, px, this.#start());
    const latest = this.#store.latest;
    if (latest) {
      const estimated = latest.estimated && compose(this.#start(), latest.estimated);
      const seen = latest.truth ?? estimated;
      if (seen) this.#drawSonars(seen, latest.ranges_m, latest.servo_rad ?? this.servo_rad, px);
      if (estimated) this.#drawRobot(estimated, px, false, false);
      if (latest.truth) this.#drawRobot(latest.truth, px, true, latest.contact);
    }
  }

  #identity() {
    return { x_m: 0, y_m: 0, heading_rad: 0 };
  }

  /** Where the odometry began. */
  #start() {
    return this.#scene?.start ?? this.#identity();
  }

  #fitted() {
    const points = this.#scene?.obstacles.flatMap((obstacle) => obstacle.corners_m) ?? [];
    const start = this.#start();
    const all = [...points, [start.x_m - 0.5, start.y_m - 0.5], [start.x_m + 0.5, start.y_m + 0.5]];
    const xs = all.map(([x]) => x ?? 0);
    const ys = all.map(([, y]) => y ?? 0);
    const [left, right, low, high] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
    return {
      x_m: (left + right) / 2,
      y_m: (low + high) / 2,
      px_per_m: Math.min(this.#canvas.clientWidth / (right - left + 2 * MARGIN_M), this.#canvas.clientHeight / (high - low + 2 * MARGIN_M)),
    };
  }

  /**
   * @param {{x_m: number, y_m: number, px_per_m: number}} view
   * @param {number} px
   */
  #drawGrid(view, px) {
    const step_m = view.px_per_m > 60 ? 0.5 : view.px_per_m > 20 ? 1 : 5;
    const half_x = this.#canvas.clientWidth / 2 / view.px_per_m;
    const half_y = this.#canvas.clientHeight / 2 / view.px_per_m;
    const context = this.#context;
    context.beginPath();
    for (let x = Math.ceil((view.x_m - half_x) / step_m) * step_m; x < view.x_m + half_x; x += step_m) {
      context.moveTo(x, view.y_m - half_y);
      context.lineTo(x, view.y_m + half_y);
    }
    for (let y = Math.ceil((view.y_m - half_y) / step_m) * step_m; y < view.y_m + half_y; y += step_m) {
      context.moveTo(view.x_m - half_x, y);
      context.lineTo(view.x_m + half_x, y);
    }
    context.lineWidth = px;
    context.strokeStyle = colours.grid;
    context.stroke();
    this.#drawScale(step_m, view.px_per_m);
  }

  /**
   * A bar as long as a square of the grid.
   * @param {number} length_m
   * @param {number} px_per_m
   */
  #drawScale(length_m, px_per_m) {
    const context = this.#context;
    const ratio = devicePixelRatio;
    context.save();
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    const bottom = this.#canvas.clientHeight - 10;
    const right = this.#canvas.clientWidth - 12;
    context.strokeStyle = context.fillStyle = colours.dim;
    context.lineWidth = 1.5;
    context.beginPath();
    context.moveTo(right - length_m * px_per_m, bottom - 4);
    context.lineTo(right - length_m * px_per_m, bottom);
    context.lineTo(right, bottom);
    context.lineTo(right, bottom - 4);
    context.stroke();
    context.font = '11px system-ui, sans-serif';
    context.textAlign = 'right';
    context.fillText(`${length_m} m`, right, bottom - 7);
    context.restore();
  }

  /** @param {number} px */
  #drawWorld(px) {
    const context = this.#context;
    context.strokeStyle = colours.wall;
    context.fillStyle = colours.wall;
    context.lineWidth = 2.5 * px;
    context.lineJoin = 'round';
    for (const { corners_m, closed } of this.#scene?.obstacles ?? []) {
      tracePath(context, corners_m, closed);
      if (closed) {
        context.globalAlpha = 0.25;
        context.fill();
        context.globalAlpha = 1;
      }
      context.stroke();
    }
  }

  /**
   * @param {[number, number][]} trail
   * @param {string} colour
   * @param {number} width_m
   * @param {Pose} origin
   */
  #drawTrail(trail, colour, width_m, origin) {
    if (trail.length < 2) return;
    const context = this.#context;
    context.save();
    context.translate(origin.x_m, origin.y_m);
    context.rotate(origin.heading_rad);
    tracePath(context, trail, false);
    context.strokeStyle = colour;
    context.lineWidth = width_m;
    context.globalAlpha = 0.7;
    context.stroke();
    context.restore();
  }

  /**
   * @param {Pose} at
   * @param {number} px
   * @param {boolean} real
   * @param {boolean} contact
   */
  #drawRobot(at, px, real, contact) {
    const context = this.#context;
    const scene = this.#scene;
    context.save();
    context.translate(at.x_m, at.y_m);
    context.rotate(at.heading_rad);
    tracePath(context, scene?.footprint_m.length ? scene.footprint_m : DEFAULT_FOOTPRINT, true);
    context.lineWidth = 1.5 * px;
    context.strokeStyle = contact ? colours.bad : real ? colours.robot : colours.text;
    if (real) {
      context.globalAlpha = 0.35;
      context.fillStyle = contact ? colours.bad : colours.robot;
      context.fill();
      context.globalAlpha = 1;
    } else {
      context.setLineDash([4 * px, 3 * px]);
    }
    context.stroke();
    context.setLineDash([]);
    if (real && scene) {
      // Wheels, and an arrow for the heading.
      context.lineWidth = 0.026;
      context.beginPath();
      for (const y of [scene.base_m / 2, -scene.base_m / 2]) {
        context.moveTo(-scene.wheel_radius_m, y);
        context.lineTo(scene.wheel_radius_m, y);
      }
      context.stroke();
    }
    context.lineWidth = 2 * px;
    context.beginPath();
    context.moveTo(0, 0);
    context.lineTo(0.07, 0);
    context.moveTo(0.045, 0.018);
    context.lineTo(0.07, 0);
    context.lineTo(0.045, -0.018);
    context.stroke();
    context.restore();
  }

  /**
   * @param {Pose} robot
   * @param {[Cell, Cell, Cell]} ranges_m
   * @param {number} servo_rad
   * @param {number} px
   */
  #drawSonars(robot, ranges_m, servo_rad, px) {
    const context = this.#context;
    for (const sonar of this.#scene?.sonars ?? []) {
      const reading = ranges_m[sonar.id];
      const mount = compose(robot, sonar.at);
      const heading = mount.heading_rad + (sonar.on_servo ? servo_rad : 0);
      const half = sonar.half_angle_rad;
      const colour = colours[SONAR_COLOURS[sonar.id] ?? 'front'];
      const reach_m = typeof reading === 'number' ? reading : reading === 'clear' ? sonar.reach_m : 0.15;
      context.beginPath();
      context.moveTo(mount.x_m, mount.y_m);
      context.arc(mount.x_m, mount.y_m, reach_m, heading - half, heading + half);
      context.closePath();
      if (typeof reading === 'number' || reading === 'clear') {
        context.globalAlpha = typeof reading === 'number' ? 0.18 : 0.07;
        context.fillStyle = colour;
        context.fill();
        context.globalAlpha = 1;
      } else {
        // No reading: a short cone in the colour of faults.
        context.strokeStyle = colours.bad;
        context.setLineDash([3 * px, 3 * px]);
        context.lineWidth = px;
        context.stroke();
        context.setLineDash([]);
      }
      if (typeof reading === 'number') {
        context.beginPath();
        context.arc(mount.x_m, mount.y_m, reach_m, heading - half, heading + half);
        context.strokeStyle = colour;
        context.lineWidth = 2.5 * px;
        context.stroke();
      }
    }
  }

  #makeNavigable() {
    const canvas = this.#canvas;
    /** @param {number} factor */
    const zoom = (factor) => {
      const view = this.#view ?? this.#fitted();
      this.#view = { ...view, px_per_m: Math.min(2_000, Math.max(5, view.px_per_m * factor)) };
      this.#redraw();
    };
    /** @param {number} dx_px @param {number} dy_px */
    const pan = (dx_px, dy_px) => {
      const view = this.#view ?? this.#fitted();
      this.#view = { ...view, x_m: view.x_m - dx_px / view.px_per_m, y_m: view.y_m + dy_px / view.px_per_m };
      this.#redraw();
    };
    const fit = () => {
      this.#view = null;
      this.#redraw();
    };
    canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      zoom(event.deltaY > 0 ? 1 / ZOOM_STEP : ZOOM_STEP);
    }, { passive: false });
    canvas.addEventListener('pointerdown', (event) => canvas.setPointerCapture(event.pointerId));
    canvas.addEventListener('pointermove', (event) => {
      if (canvas.hasPointerCapture(event.pointerId)) pan(event.movementX, event.movementY);
    });
    canvas.addEventListener('dblclick', fit);
    /** @type {Record<string, () => void>} */
    const keys = {
      '+': () => zoom(ZOOM_STEP),
      '-': () => zoom(1 / ZOOM_STEP),
      0: fit,
      ArrowLeft: () => pan(KEY_PAN_PX, 0),
      ArrowRight: () => pan(-KEY_PAN_PX, 0),
      ArrowUp: () => pan(0, KEY_PAN_PX),
      ArrowDown: () => pan(0, -KEY_PAN_PX),
    };
    canvas.addEventListener('keydown', (event) => {
      const act = keys[event.key];
      if (!act) return;
      event.preventDefault();
      act();
    });
  }
}

/**
 * A pose in the frame of another one.
 * @param {Pose} frame
 * @param {Pose} at
 * @returns {Pose}
 */
function compose(frame, at) {
  const cos = Math.cos(frame.heading_rad);
  const sin = Math.sin(frame.heading_rad);
  return {
    x_m: frame.x_m + cos * at.x_m - sin * at.y_m,
    y_m: frame.y_m + sin * at.x_m + cos * at.y_m,
    heading_rad: frame.heading_rad + at.heading_rad,
  };
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {[number, number][]} points
 * @param {boolean} closed
 */
function tracePath(context, points, closed) {
  context.beginPath();
  for (const [x, y] of points) context.lineTo(x, y);
  if (closed) context.closePath();
}
