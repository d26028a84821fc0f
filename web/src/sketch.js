// @ts-check
/** What the map shows, drawn on a canvas in metres: world, trails, robot, the sonars' cones with their readings, goal and route. */
import { compose, likelyArea, place } from './geometry.js';
import { colours, stateColour } from './theme.js';
import { formatShort } from './units.js';

/** @typedef {import('./types.js').Scene} Scene */
/** @typedef {import('./types.js').Cell} Cell */
/** @typedef {import('./types.js').Pose} Pose */
/** @typedef {import('./types.js').Spread} Spread */
/** @typedef {import('./theme.js').ColourName} ColourName */
/** @typedef {[number, number]} Point In the world [m]. */

/** Outline of a robot of which nothing is known [m]. */
const DEFAULT_FOOTPRINT = /** @type {[number, number][]} */ ([[0.1, 0.075], [-0.1, 0.075], [-0.1, -0.075], [0.1, -0.075]]);
const SONAR_COLOURS = /** @type {ColourName[]} */ (['left', 'right', 'front', 'goal', 'reference']);
/** Radius of the heading's sector [m]. */
const POINTER_M = 0.25;
/** So many standard deviations to both sides are 95 %. */
const DEVIATIONS_95 = 1.96;
/** Size of a goal's mark [px]. */
const GOAL_PX = 9;
const LAMP_PX = 5;
/** Radius of the glow of a lamp of 1 lm, and the widest [m]. */
const GLOW_M = 0.02;
const MOST_GLOW_M = 1.5;

/** Draws the parts of the map. */
export class Sketch {
  /** @type {Scene | null} */
  scene = null;
  /** The body by the robot's parameters; a simulated body takes precedence. @type {import('./mounts.js').Body | null} */
  body = null;
  /** Each trail as a path. @type {WeakMap<Point[], {first: Point, points: number, path: Path2D}>} */
  #trails = new WeakMap();

  /**
   * @param {HTMLCanvasElement} canvas
   * @param {CanvasRenderingContext2D} context
   */
  constructor(canvas, context) {
    this.canvas = canvas;
    this.context = context;
  }

  /** Width and height of the canvas [px]: asked for in each frame they would be a layout for each. @type {Point | null} */
  #size = null;

  get size() {
    return this.#size ??= [this.canvas.clientWidth, this.canvas.clientHeight];
  }

  resized() {
    this.#size = null;
  }

  /** The scene, unless it is of a ghost. */
  get #simulated() {
    return this.scene?.of_ghost ? null : this.scene;
  }

  /**
   * @param {{x_m: number, y_m: number, px_per_m: number}} view
   * @param {number} px
   */
  drawGrid(view, px) {
    const step_m = squareOf(view);
    const [half_x, half_y] = /** @type {Point} */ (this.size.map((each) => each / 2 / view.px_per_m));
    const context = this.context;
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
  }

  /** Axes of a frame: x forward, y left. @param {import('./types.js').Pose} frame @param {number} px */
  drawAxes(frame, px) {
    const { context } = this;
    context.save();
    context.translate(frame.x_m, frame.y_m);
    context.rotate(frame.heading_rad);
    context.strokeStyle = context.fillStyle = colours.goal;
    context.lineWidth = 1.5 * px;
    context.font = `${11 * px}px system-ui, sans-serif`;
    for (const [name, x, y] of /** @type {const} */ ([['x', 1, 0], ['y', 0, 1]])) {
      const long = 34 * px;
      context.beginPath();
      context.moveTo(0, 0);
      context.lineTo(x * long, y * long);
      context.lineTo(x * long - (4 * x + 3 * y) * px, y * long - (4 * y + 3 * x) * px);
      context.stroke();
      context.save();
      context.translate(x * (long + 9 * px), y * (long + 9 * px));
      context.rotate(-frame.heading_rad);
      context.scale(1, -1);
      context.textAlign = 'center';
      context.textBaseline = 'middle';
      context.fillText(name, 0, 0);
      context.restore();
    }
    context.restore();
  }

  /** A bar as long as a square of the grid. @param {{px_per_m: number}} view */
  drawScale({ px_per_m }) {
    const length_m = squareOf({ px_per_m });
    const context = this.context;
    const ratio = devicePixelRatio;
    context.save();
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    const [right, bottom] = [this.size[0] - 12, this.size[1] - 10];
    context.globalAlpha = 0.95;
    context.fillStyle = colours.panel;
    context.fillRect(right - length_m * px_per_m - 4, bottom - 22, length_m * px_per_m + 8, 26);
    context.globalAlpha = 1;
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
    context.fillText(`${formatShort(length_m)} m`, right, bottom - 7);
    context.restore();
  }

  /**
   * The part of the world that a map shows.
   * @param {Point} from
   * @param {Point} to
   * @param {number} px
   */
  drawArena([x0, y0], [x1, y1], px) {
    const context = this.context;
    context.strokeStyle = colours.dim;
    context.lineWidth = px;
    context.setLineDash([4 * px, 4 * px]);
    context.strokeRect(x0, y0, x1 - x0, y1 - y0);
    context.setLineDash([]);
  }

  /** @param {number} px @param {import('./types.js').Obstacle[]} outlines of what stands and moves */
  drawWorld(px, outlines) {
    this.drawLines();
    this.drawLamps(px, this.scene?.lamps ?? []);
    this.drawOutlines(px, outlines);
  }

  /** Dark lines on the floor. */
  drawLines() {
    const context = this.context;
    context.strokeStyle = colours.text;
    context.lineJoin = 'round';
    for (const { points_m, width_m } of this.scene?.lines ?? []) {
      context.lineWidth = width_m;
      tracePath(context, points_m, false);
      context.stroke();
    }
  }

  /** Lamps, each with a glow as wide as it is bright. @param {number} px @param {{at_m: [number, number], lumen: number}[]} lamps */
  drawLamps(px, lamps) {
    const context = this.context;
    for (const { at_m: [x, y], lumen } of lamps) {
      const glow_m = Math.min(GLOW_M * Math.sqrt(lumen), MOST_GLOW_M);
      const glow = context.createRadialGradient(x, y, 0, x, y, glow_m);
      glow.addColorStop(0, colours.lamp);
      glow.addColorStop(1, 'transparent');
      context.globalAlpha = 0.4;
      context.fillStyle = glow;
      context.fillRect(x - glow_m, y - glow_m, 2 * glow_m, 2 * glow_m);
      context.globalAlpha = 1;
      context.fillStyle = colours.lamp;
      context.beginPath();
      context.arc(x, y, LAMP_PX * px, 0, 2 * Math.PI);
      context.fill();
    }
  }

  /** @param {number} px @param {import('./types.js').Obstacle[]} obstacles @param {string} [colour] */
  drawOutlines(px, obstacles, colour = colours.wall) {
    const context = this.context;
    context.strokeStyle = colour;
    context.fillStyle = colour;
    context.lineWidth = 2.5 * px;
    context.lineJoin = 'round';
    for (const { corners_m, closed } of obstacles) this.#drawOutline(corners_m, closed);
  }

  /** @param {[number, number][]} corners_m @param {boolean} closed */
  #drawOutline(corners_m, closed) {
    const context = this.context;
    tracePath(context, corners_m, closed);
    if (closed) {
      context.globalAlpha = 0.25;
      context.fill();
      context.globalAlpha = 1;
    }
    context.stroke();
  }

  /**
   * @param {[number, number][]} trail In the world.
   * @param {string} colour
   * @param {number} width_m
   */
  drawTrail(trail, colour, width_m) {
    const [first] = trail;
    if (!first) return;
    const context = this.context;
    // It grows at its end, until its beginning goes.
    let known = this.#trails.get(trail);
    if (!known || known.first !== first) this.#trails.set(trail, known = { first, points: 0, path: new Path2D() });
    for (const [x, y] of trail.slice(known.points)) known.path.lineTo(x, y);
    known.points = trail.length;
    context.strokeStyle = colour;
    context.lineWidth = width_m;
    context.globalAlpha = 0.7;
    context.stroke(known.path);
    context.globalAlpha = 1;
  }

  /**
   * @param {Pose} at
   * @param {number} px
   * @param {'real' | 'estimated' | 'ghost'} kind
   * @param {boolean} contact
   */
  drawRobot(at, px, kind, contact) {
    const real = kind === 'real';
    const context = this.context;
    const footprint = this.scene?.footprint_m ?? [];
    const body = this.#simulated ?? this.body;
    context.save();
    context.translate(at.x_m, at.y_m);
    context.rotate(at.heading_rad);
    tracePath(context, footprint.length > 0 ? footprint : DEFAULT_FOOTPRINT, true);
    context.lineWidth = 1.5 * px;
    context.strokeStyle = contact ? colours.bad : real ? colours.robot : kind === 'ghost' ? colours.goal : colours.text;
    if (real) {
      context.globalAlpha = 0.35;
      context.fillStyle = contact ? colours.bad : colours.robot;
      context.fill();
      context.globalAlpha = 1;
    } else {
      context.setLineDash(kind === 'ghost' ? [1.5 * px, 2.5 * px] : [4 * px, 3 * px]);
    }
    context.stroke();
    context.setLineDash([]);
    if (real && body) {
      // Wheels, and an arrow for the heading.
      context.lineWidth = 0.026;
      context.beginPath();
      for (const y of [body.base_m / 2, -body.base_m / 2]) {
        context.moveTo(-body.wheel_radius_m, y);
        context.lineTo(body.wheel_radius_m, y);
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

  /** Where a small robot is, and its heading. @param {Pose} at @param {number} radius_m @param {number} px */
  drawRing({ x_m, y_m, heading_rad }, radius_m, px) {
    const context = this.context;
    const [cos, sin] = [Math.cos(heading_rad), Math.sin(heading_rad)];
    context.beginPath();
    context.moveTo(x_m + 1.5 * radius_m * cos, y_m + 1.5 * radius_m * sin);
    context.arc(x_m, y_m, radius_m, heading_rad + 0.4, heading_rad - 0.4 + 2 * Math.PI);
    context.closePath();
    context.strokeStyle = colours.robot;
    context.lineWidth = 1.5 * px;
    context.stroke();
  }

  /**
   * Another robot, with its name, in a colour of its own.
   * @param {{name: string, footprint_m: Point[]}} other
   * @param {Pose} at
   * @param {number} number among all robots
   * @param {number} px
   * @param {number} name_m where the name stands, above it
   */
  drawOther({ name, footprint_m }, at, number, px, name_m) {
    const context = this.context;
    this.drawOutlines(px, [{ corners_m: footprint_m.map((corner) => place(at, corner)), closed: true }], stateColour(number));
    context.save();
    context.translate(at.x_m, at.y_m);
    // Fonts of a few hundredths of a unit are badly set.
    context.scale(px, -px);
    context.fillStyle = colours.text;
    context.font = '11px sans-serif';
    context.textAlign = 'center';
    context.textBaseline = 'middle';
    context.fillText(name, 0, -name_m / px);
    context.restore();
    context.beginPath();
    context.moveTo(at.x_m, at.y_m);
    context.lineTo(...place(at, [0.09, 0]));
    context.lineWidth = 2 * px;
    context.strokeStyle = colours.text;
    context.stroke();
  }

  /** The robots of other seeds: their outlines, faint. @param {Pose[]} poses @param {number} px */
  drawSeeds(poses, px) {
    const { context, scene } = this;
    context.beginPath();
    for (const at of poses) {
      (scene?.footprint_m ?? DEFAULT_FOOTPRINT).forEach((corner, index) => (index === 0 ? context.moveTo(...place(at, corner)) : context.lineTo(...place(at, corner))));
      context.closePath();
    }
    context.lineWidth = px;
    context.globalAlpha = 0.4;
    context.strokeStyle = colours.robot;
    context.stroke();
    context.globalAlpha = 1;
  }

  /**
   * The 95 % regions of the estimated position and heading.
   * @param {Pose} at
   * @param {Pose} origin
   * @param {Spread} spread
   * @param {number} px
   */
  drawSpread(at, origin, spread, px) {
    const context = this.context;
    const { half_m, direction_rad } = likelyArea(spread);
    const [long_m = 0, short_m = 0] = half_m;
    context.beginPath();
    context.ellipse(at.x_m, at.y_m, long_m, short_m, origin.heading_rad + direction_rad, 0, 2 * Math.PI);
    context.fillStyle = context.strokeStyle = colours.text;
    context.globalAlpha = 0.08;
    context.fill();
    const off_rad = Math.min(DEVIATIONS_95 * spread.heading_rad, Math.PI);
    context.beginPath();
    context.moveTo(at.x_m, at.y_m);
    context.arc(at.x_m, at.y_m, POINTER_M, at.heading_rad - off_rad, at.heading_rad + off_rad);
    context.fill();
    context.globalAlpha = 0.5;
    context.lineWidth = px;
    context.beginPath();
    context.ellipse(at.x_m, at.y_m, long_m, short_m, origin.heading_rad + direction_rad, 0, 2 * Math.PI);
    context.stroke();
    context.globalAlpha = 1;
  }

  /**
   * @param {Pose} robot
   * @param {Cell[]} ranges_m
   * @param {number} servo_rad
   * @param {number} px
   */
  drawSonars(robot, ranges_m, servo_rad, px) {
    const context = this.context;
    for (const sonar of (this.#simulated ?? this.body)?.sonars ?? []) {
      const reading = ranges_m[sonar.id];
      const mount = compose(robot, sonar.at);
      const heading = mount.heading_rad + (sonar.on_servo ? servo_rad : 0);
      const half = sonar.half_angle_rad;
      const colour = colours[SONAR_COLOURS[sonar.id % SONAR_COLOURS.length] ?? 'front'];
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

  /**
   * The goal.
   * @param {Point} at
   * @param {Point | null} from
   * @param {number} px
   */
  drawGoal(at, from, px) {
    const context = this.context;
    context.strokeStyle = context.fillStyle = colours.goal;
    if (from) {
      context.lineWidth = px;
      context.setLineDash([2 * px, 5 * px]);
      tracePath(context, [from, at], false);
      context.stroke();
      context.setLineDash([]);
    }
    context.lineWidth = 2 * px;
    context.beginPath();
    context.arc(at[0], at[1], GOAL_PX * px, 0, 2 * Math.PI);
    for (const [x, y] of [[1, 0], [0, 1]]) {
      const reach = 1.6 * GOAL_PX * px;
      context.moveTo(at[0] - /** @type {number} */ (x) * reach, at[1] - /** @type {number} */ (y) * reach);
      context.lineTo(at[0] + /** @type {number} */ (x) * reach, at[1] + /** @type {number} */ (y) * reach);
    }
    context.stroke();
  }

  /** The middle of the map, where Enter picks a place. */
  drawAim() {
    const context = this.context;
    const ratio = devicePixelRatio;
    context.save();
    context.setTransform(ratio, 0, 0, ratio, this.size[0] / 2 * ratio, this.size[1] / 2 * ratio);
    context.strokeStyle = colours.text;
    context.lineWidth = 1;
    context.beginPath();
    for (const [x, y] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
      context.moveTo(4 * (x ?? 0), 4 * (y ?? 0));
      context.lineTo(12 * (x ?? 0), 12 * (y ?? 0));
    }
    context.stroke();
    context.restore();
  }

  /**
   * The goal in the robot's own frame.
   * @param {Point} at
   * @param {number} px
   */
  drawBelievedGoal(at, px) {
    const context = this.context;
    context.strokeStyle = colours.text;
    context.lineWidth = px;
    context.setLineDash([3 * px, 3 * px]);
    context.beginPath();
    context.arc(at[0], at[1], GOAL_PX * px, 0, 2 * Math.PI);
    context.stroke();
    context.setLineDash([]);
  }

  /**
   * A route with its numbered places; a draft is dashed.
   * @param {Point[]} points
   * @param {{from: Point | null, repeat: boolean, draft: boolean}} how `from`: where it begins.
   * @param {number} px
   */
  drawRoute(points, { from, repeat, draft }, px) {
    if (points.length === 0) return;
    const context = this.context;
    context.strokeStyle = context.fillStyle = draft ? colours.text : colours.goal;
    context.globalAlpha = draft ? 0.6 : 0.9;
    context.lineWidth = 1.5 * px;
    context.setLineDash(draft ? [6 * px, 4 * px] : []);
    tracePath(context, from ? [from, ...points] : points, false);
    context.stroke();
    const [first, last] = [points[0], points.at(-1)];
    if (repeat && first && last) {
      context.setLineDash([2 * px, 4 * px]);
      tracePath(context, [last, first], false);
      context.stroke();
    }
    context.setLineDash([]);
    /** Places that are visited twice get both numbers. @type {Map<string, {at: Point, label: string}>} */
    const labels = new Map();
    points.forEach((at, index) => {
      const key = at.map((each) => each.toFixed(2)).join();
      const known = labels.get(key);
      labels.set(key, { at, label: known ? `${known.label}, ${index + 1}` : String(index + 1) });
    });
    for (const { at, label } of labels.values()) {
      context.beginPath();
      context.arc(at[0], at[1], 3.5 * px, 0, 2 * Math.PI);
      context.fill();
      this.#write(label, at, px);
    }
    context.globalAlpha = 1;
  }

  /**
   * @param {string} text
   * @param {Point} at
   * @param {number} px
   */
  #write(text, [x, y], px) {
    const context = this.context;
    context.save();
    context.translate(x, y);
    // Text is upright where y is down.
    context.scale(px, -px);
    context.font = `${12 * devicePixelRatio}px system-ui, sans-serif`;
    context.textAlign = 'left';
    context.textBaseline = 'bottom';
    context.fillText(text, 7, -4);
    context.restore();
  }
}

/** Side of a square of the grid [m]. @param {{px_per_m: number}} view */
const squareOf = ({ px_per_m }) => (px_per_m > 60 ? 0.5 : px_per_m > 20 ? 1 : 5);

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
