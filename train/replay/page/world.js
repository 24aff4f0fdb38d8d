// @ts-check
/** The world of a run on a canvas. */
import { placesOf, settingOf, valueAt } from "./recording.js";
import { Field, shorter } from "./course.js";
import { LOOK } from "./look.js";
import { drawField, drawSigns, drawThing, drawWalls, drawZones } from "./floor.js";
import { drawNumbers, drawPaths, drawReach, drawRobots, drawSeen } from "./robots.js";
/** @typedef {import("./recording.js").Run} Run */
/** @typedef {import("./look.js").Colours} Colours */
/** @typedef {import("./look.js").Layers} Layers */

const NEAR = 14; // distance up to which a press means a thing, or its radius where that is more [pixels]

/** A canvas that shows one run. */
export class WorldView {
  /** @param {Run} run @param {HTMLCanvasElement} canvas */
  constructor(run, canvas) {
    this.run = run;
    this.canvas = canvas;
    this.field = new Field(run);
    this.zoom = run.head.field ? Math.max(1, Math.min(12, run.head.width / (1.5 * run.head.field))) : 1;
    this.centre = this.middle;
    this.x = new Float64Array(run.head.robots);
    this.y = new Float64Array(run.head.robots);
    this.turn = new Float64Array(run.head.robots);
    this.corners = new Uint8Array(run.head.robots); // at which the numbers of robots stood in the picture before
    this.fieldPicture = document.createElement("canvas");
    this.wide = canvas.width; // width and height of the canvas [CSS pixels], of which each is `ratio` pixels of the screen
    this.high = canvas.height;
    this.ratio = 1;
  }

  /** Width and height of what is shown of the world [m]; of a walled field it is less than its torus. @returns {[number, number]} */
  get shown() {
    return this.run.head.shown ?? [this.run.head.width, this.run.head.height];
  }

  /** The middle of what is shown [m]. @returns {[number, number]} */
  get middle() {
    return [this.shown[0] / 2, this.shown[1] / 2];
  }

  /** Make the canvas as large as fits. @param {number} width @param {number} height [CSS pixels] */
  fit(width, height) {
    const [across, up] = this.shown, wide = Math.max(120, Math.min(width, (height * across) / up));
    [this.wide, this.high, this.ratio] = [wide, (wide * up) / across, Math.min(2, Math.max(1, devicePixelRatio || 1))];
    this.canvas.width = Math.round(this.wide * this.ratio);
    this.canvas.height = Math.round(this.high * this.ratio);
    this.canvas.style.width = `${this.wide}px`;
    this.canvas.style.height = `${this.high}px`;
  }

  /** Return CSS pixels of a metre. */
  get scale() {
    return (this.wide / this.shown[0]) * this.zoom;
  }

  /** Return where a point of the world is on the canvas, by the image nearest to the centre. @param {number} x @param {number} y @returns {[number, number]} */
  place(x, y) {
    const { width, height } = this.run.head, s = this.scale;
    const dx = shorter(x - this.centre[0], width), dy = shorter(y - this.centre[1], height);
    return [this.wide / 2 + dx * s, this.high / 2 - dy * s];
  }

  /** Compute the poses at a frame and a share of the way to the next one. @param {number} frame @param {number} share */
  pose(frame, share) {
    const { run } = this, { width, height, robots } = run.head;
    const next = Math.min(frame + 1, run.frames - 1);
    const there = run.tracks.get("present")?.room;
    for (let i = 0; i < robots; i++) {
      const [x, y, turn] = ["x", "y", "heading"].map((name) => valueAt(run, name, frame, i));
      const moves = share > 0 && there?.[frame * robots + i];
      const dx = moves ? shorter(valueAt(run, "x", next, i) - x, width) : 0, dy = moves ? shorter(valueAt(run, "y", next, i) - y, height) : 0;
      const near = moves && Math.hypot(dx, dy) < 1;
      this.x[i] = (((near ? x + share * dx : x) % width) + width) % width;
      this.y[i] = (((near ? y + share * dy : y) % height) + height) % height;
      this.turn[i] = near ? turn + share * shorter(valueAt(run, "heading", next, i) - turn, 2 * Math.PI) : turn;
    }
  }

  /** Return the point of the world at a place on the canvas [shares of its size]. @param {number} px @param {number} py @returns {[number, number]} */
  pointAt(px, py) {
    const { width, height } = this.run.head, { scale } = this;
    const x = this.centre[0] + ((px - 0.5) * this.wide) / scale, y = this.centre[1] - ((py - 0.5) * this.high) / scale;
    return [((x % width) + width) % width, ((y % height) + height) % height];
  }

  /**
   * Return the robot or the lying item nearest to a place on the canvas [shares of its size]; its number is -1 where
   * nothing is near. What can be clicked can be dragged.
   * @param {number} px @param {number} py @param {number} frame @returns {{kind: "robot" | "item", number: number}}
   */
  thingAt(px, py, frame) {
    const { run } = this;
    /** @type {{kind: "robot" | "item", number: number}} */
    let best = { kind: "robot", number: -1 };
    let least = Infinity;
    /** @param {"robot" | "item"} kind @param {number} number @param {number} mx @param {number} my @param {number} size */
    const take = (kind, number, mx, my, size) => {
      const [x, y] = this.place(mx, my), d = Math.hypot(x - px * this.wide, y - py * this.high);
      if (d < least && d <= Math.max(NEAR, size * this.scale)) [best, least] = [{ kind, number }, d];
    };
    for (const i of this.rows) take("robot", i, this.x[i], this.y[i], settingOf(run, i, "radius"));
    for (const one of run.head.drawn ?? [])
      if (one.at === "item") for (const [x, y, k] of placesOf(run, one, frame)) take("item", k, x, y, LOOK.item.half);
    return best;
  }

  /** Robots that are there. @type {number[]} */
  rows = [];

  /** Robots as they were drawn last, if as discs: place and radius [pixels], and number; over a seam more than once. @type {[number, number, number, number][]} */
  discs = [];

  /** Middle and half width of each number of a robot, and of each share, as they were written last [pixels]. @type {[number, number, number][]} */
  numbers = [];

  /** What else is drawn over the robots. @type {((view: WorldView, frame: number, chosen: number, layers: Layers, colours: Colours) => void)[]} */
  over = [];

  /**
   * Draw a moment.
   * @param {number} frame @param {number} share @param {number} chosen @param {Layers} layers @param {Colours} colours
   */
  draw(frame, share, chosen, layers, colours) {
    const { run, canvas } = this, c = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
    const robots = run.head.robots, there = run.tracks.get("present")?.room;
    this.rows = [];
    for (let i = 0; i < robots; i++) if (!there || there[frame * robots + i]) this.rows.push(i);
    this.pose(frame, share);
    c.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    c.fillStyle = colours.paper;
    c.fillRect(0, 0, this.wide, this.high);
    if (layers.fields) drawField(this, c, frame);
    drawZones(this, c, colours);
    drawSigns(this, c, frame, colours, true);
    for (const thing of run.head.things ?? []) drawThing(this, c, thing, frame, share, colours);
    if (layers.paths) drawPaths(this, c, frame, chosen, colours);
    if (layers.seen) drawSeen(this, c, frame, chosen, colours);
    if (layers.reach || layers.view) drawReach(this, c, frame, chosen, layers);
    drawSigns(this, c, frame, colours, false);
    if (layers.walls) drawWalls(this, c, colours);
    [this.discs, this.numbers] = [[], []];
    drawRobots(this, c, frame, chosen, layers, colours);
    for (const draw of this.over) draw(this, frame, chosen, layers, colours);
    if (layers.numbers && (this.rows.length <= LOOK.most_numbered || this.zoom > 2)) drawNumbers(this, c, colours);
    this.drawFrame(c, colours);
  }

  /** Draw the border of the world where it is in sight. @param {CanvasRenderingContext2D} c @param {Colours} colours */
  drawFrame(c, colours) {
    const [across, up] = this.shown;
    if (this.zoom > 1 || this.centre[0] !== across / 2) {
      const [x, y] = [this.wide / 2 + (0 - this.centre[0]) * this.scale, this.high / 2 + this.centre[1] * this.scale];
      c.strokeStyle = colours.faint;
      c.setLineDash([6, 6]);
      c.strokeRect(x, y - up * this.scale, across * this.scale, up * this.scale);
      c.setLineDash([]);
    }
  }

  /** Call `draw` for each image of a disc that can be seen. @param {number} x @param {number} y @param {number} r [m] @param {(x: number, y: number) => void} draw */
  images(x, y, r, draw) {
    const { width, height } = this.run.head, s = this.scale;
    const [px, py] = this.place(x, y), w = width * s, h = height * s, R = r * s;
    for (let a = -1; a <= 1; a++)
      for (let b = -1; b <= 1; b++) {
        const qx = px + a * w, qy = py + b * h;
        if (qx > -R && qx < this.wide + R && qy > -R && qy < this.high + R) draw(qx, qy);
      }
  }
}
