// @ts-check
/** The world of a run on a canvas. */
import { settingOf, valueAt } from "./recording.js";
import { Field, seenPairs, shorter } from "./course.js";
/** @typedef {import("./recording.js").Run} Run */
/** @typedef {Record<string, boolean>} Layers by their names: whether each is shown */
/** @typedef {{ink: string, paper: string, faint: string}} Colours */

/** @typedef {{word: string, colour: string, shape: string, half: number, letter: string, opacity: number}} Sign */
/**
 * How things look, as `clean_swarm_env/drawing/look.py` defines it; legends: of other tasks, and of cleaning.
 * @type {{options: string[], ink: string, paper: string, edge: string, attracts: string, repels: string, contact: string, area_opacity: number,
 *   least_area: number, front_angle: number, front_length: number, cargo_behind: number, cargo_half: number, marks: string[], mark_half: number, letter_size: number,
 *   most_numbered: number, least_numbered: number, failed: Sign, item: Sign, leftovers: Sign, stations: Sign[], pheromones: Sign,
 *   zone: Sign, wall: Sign, wall_width: number, layers: [string, Sign][], legends: [Sign[], Sign[]]}}
 */
export const LOOK = JSON.parse(document.getElementById("look")?.textContent ?? "");

/** Return the colour of a number: of an option, a term, or a kind of events. @param {number} k */
export const colourOf = (k) => LOOK.options[k % LOOK.options.length];

/** Return red, green and blue of a colour. @param {string} colour */
const partsOf = (colour) => [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));

/** Return a colour with an opacity. @param {string} colour @param {number} opacity */
const faded = (colour, opacity) => `rgb(${partsOf(colour).join(" ")} / ${opacity})`;
/** Escape a text for HTML. @param {unknown} text */
export const plain = (text) => String(text).replace(/[&<>"]/g, (sign) => `&#${sign.charCodeAt(0)};`);

/** Return the sign of a legend as HTML. @param {Sign} sign */
export const keyOf = ({ colour, shape, half, letter, opacity }) => {
  const own = colour === LOOK.ink ? "var(--ink)" : faded(colour, opacity); // ink is bright on a dark page
  return `<i class="key ${shape}" style="background:${own};--own:${own};--size:${(0.8 * half) / LOOK.item.half}">${letter}</i>`;
};

const LEFT = LOOK.leftovers.half / LOOK.item.half; // how much smaller leftovers are than items
const PATH_SECONDS = 20;
const SMALL = 4; // size of a robot or an item below which it is a square: paths of a thousand discs take too long [pixels]
const FEW = 200; // items up to which they are never smaller than that
const NEAR = 14; // distance up to which a press means a thing, or its radius where that is more [pixels]
const MOST_PATHS = 60; // robots up to which all paths are drawn, and all reaches; of larger teams the chosen robot's

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
    for (let k = 0; k < run.head.items; k++)
      if (valueAt(run, "item_stage", frame, k) === 0) take("item", k, valueAt(run, "item_x", frame, k), valueAt(run, "item_y", frame, k), LOOK.item.half);
    return best;
  }

  /** Robots that are there. @type {number[]} */
  rows = [];

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
    if (layers.fields) this.drawField(c, frame);
    this.drawZones(c, colours);
    this.drawStations(c, frame);
    for (const thing of run.head.things ?? []) this.drawThing(c, thing, frame, share, colours);
    if (layers.paths) this.drawPaths(c, frame, chosen, colours);
    if (layers.seen) this.drawSeen(c, frame, chosen, colours);
    if (layers.reach || layers.view) this.drawReach(c, frame, chosen, layers);
    this.drawItems(c, frame, colours);
    if (layers.walls) this.drawWalls(c, colours);
    this.drawRobots(c, frame, chosen, layers, colours);
    for (const draw of this.over) draw(this, frame, chosen, layers, colours);
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

  /** @param {CanvasRenderingContext2D} c @param {Colours} colours */
  drawZones(c, colours) {
    for (const [name, left, bottom, right, top] of this.run.head.zones ?? []) {
      const wide = (right - left) * this.scale, high = (top - bottom) * this.scale;
      this.images((left + right) / 2, (bottom + top) / 2, Math.max(right - left, top - bottom) / 2, (x, y) => {
        c.fillStyle = faded(LOOK.zone.colour, LOOK.zone.opacity);
        c.fillRect(x - wide / 2, y - high / 2, wide, high);
        c.fillStyle = colours.ink;
        c.font = `${LOOK.letter_size}px sans-serif`;
        c.textAlign = "left";
        c.fillText(name, x - wide / 2 + 6, y + high / 2 - 6);
      });
    }
  }

  /** @param {CanvasRenderingContext2D} c @param {Colours} colours */
  drawWalls(c, colours) {
    c.strokeStyle = colours.ink;
    c.lineWidth = LOOK.wall_width;
    c.lineCap = "round";
    c.beginPath();
    for (const [ax, ay, bx, by] of this.run.head.walls ?? []) {
      const x = (ax + bx) / 2, y = (ay + by) / 2, s = this.scale;
      this.images(x, y, Math.hypot(bx - ax, by - ay) / 2, (px, py) => {
        c.moveTo(px + (ax - x) * s, py - (ay - y) * s);
        c.lineTo(px + (bx - x) * s, py - (by - y) * s);
      });
    }
    c.stroke();
    c.lineCap = "butt";
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

  /** @param {CanvasRenderingContext2D} c @param {number} frame */
  drawField(c, frame) {
    const { field, fieldPicture, run } = this;
    if (!run.deposits.length) return;
    const step = Math.max(1, Math.round(1 / run.head.period)), moment = frame - (frame % step);
    if (field.shown !== moment || fieldPicture.width !== field.nx) {
      const reach = field.at(moment), most = Math.max(...run.deposits.map((kind) => kind.diffusion));
      fieldPicture.width = field.nx;
      fieldPicture.height = field.ny;
      const f = /** @type {CanvasRenderingContext2D} */ (fieldPicture.getContext("2d"));
      const picture = f.createImageData(field.nx, field.ny), trail = partsOf(LOOK.pheromones.colour);
      for (let cy = 0; cy < field.ny; cy++)
        for (let cx = 0; cx < field.nx; cx++) {
          const at = 4 * ((field.ny - 1 - cy) * field.nx + cx);
          picture.data.set([...trail, 255 * LOOK.pheromones.opacity * Math.min(1, Math.max(0, reach[cy * field.nx + cx] / most))], at);
        }
      f.putImageData(picture, 0, 0);
    }
    const { width, height } = run.head;
    this.images(width / 2, height / 2, Math.max(width, height), (x, y) =>
      c.drawImage(fieldPicture, x - (width / 2) * this.scale, y - (height / 2) * this.scale, width * this.scale, height * this.scale));
  }

  /** @param {CanvasRenderingContext2D} c @param {number} frame */
  drawStations(c, frame) {
    if (!this.run.tracks.has("station_x")) return;
    const { mission } = this.run.head, s = this.scale;
    const { reach, further_recycling = [], further_dumps = [] } = mission.task?.stations ?? mission.stations; // earlier recordings
    const [recycling, dump] = LOOK.stations;
    const stations = [recycling, dump, ...further_recycling.map(() => recycling), ...further_dumps.map(() => dump)];
    stations.forEach((sign, k) => {
      this.images(valueAt(this.run, "station_x", frame, k), valueAt(this.run, "station_y", frame, k), reach, (x, y) => {
        this.drawArea(c, x, y, reach * s, sign.colour);
        const half = Math.max(5, sign.half * s);
        c.fillStyle = sign.colour;
        c.fillRect(x - half, y - half, 2 * half, 2 * half);
        c.fillStyle = "#fff";
        c.font = `${Math.round(1.5 * half)}px sans-serif`;
        c.textAlign = "center";
        c.textBaseline = "middle";
        c.fillText(sign.letter, x, y);
      });
    });
  }

  /**
   * Return where a thing is at a frame and a share of the way to the next one.
   * @param {import("./recording.js").Thing} thing @param {number} frame @param {number} share @returns {[number, number]}
   */
  placeOf({ x, y, moves }, frame, share) {
    if (moves === undefined) return [x, y];
    const { run } = this, next = Math.min(frame + 1, run.frames - 1);
    const nowX = valueAt(run, "thing_x", frame, moves), nowY = valueAt(run, "thing_y", frame, moves);
    if (share <= 0) return [nowX, nowY];
    return [
      nowX + share * shorter(valueAt(run, "thing_x", next, moves) - nowX, run.head.width),
      nowY + share * shorter(valueAt(run, "thing_y", next, moves) - nowY, run.head.height),
    ];
  }

  /**
   * Draw what attracts or repels robots.
   * @param {CanvasRenderingContext2D} c @param {import("./recording.js").Thing} thing @param {number} frame @param {number} share @param {Colours} colours
   */
  drawThing(c, thing, frame, share, colours) {
    const { channel, attraction, radius } = thing, [x, y] = this.placeOf(thing, frame, share);
    const size = Math.max(radius, LOOK.least_area);
    this.images(x, y, size, (px, py) => {
      this.drawArea(c, px, py, size * this.scale, attraction < 0 ? LOOK.repels : LOOK.attracts);
      c.fillStyle = colours.ink;
      c.font = `${LOOK.letter_size}px sans-serif`;
      c.textAlign = "center";
      c.fillText(channel, px, py + 4);
    });
  }

  /** Draw a disc that means something to robots. @param {CanvasRenderingContext2D} c @param {number} x @param {number} y @param {number} r @param {string} colour */
  drawArea(c, x, y, r, colour) {
    c.strokeStyle = colour;
    c.fillStyle = faded(colour, LOOK.area_opacity);
    c.lineWidth = 1;
    c.beginPath();
    c.arc(x, y, r, 0, 7);
    c.fill();
    c.stroke();
  }

  /** @param {CanvasRenderingContext2D} c @param {number} x @param {number} y @param {number} size */
  diamond(c, x, y, size) {
    c.moveTo(x - size, y);
    c.lineTo(x, y - size);
    c.lineTo(x + size, y);
    c.lineTo(x, y + size);
    c.closePath();
  }

  /** @param {CanvasRenderingContext2D} c @param {number} frame @param {Colours} colours */
  drawItems(c, frame, colours) {
    const { run } = this, size = Math.max(run.head.items > FEW ? 2 : SMALL, LOOK.item.half * this.scale);
    c.fillStyle = LOOK.item.colour;
    if (size < SMALL) {
      for (let k = 0; k < run.head.items; k++)
        if (valueAt(run, "item_stage", frame, k) === 0) {
          const [x, y] = this.place(valueAt(run, "item_x", frame, k), valueAt(run, "item_y", frame, k));
          c.fillRect(Math.round(x) - 1, Math.round(y) - 1, 3, 3);
        }
      return;
    }
    c.beginPath();
    for (let k = 0; k < run.head.items; k++)
      if (valueAt(run, "item_stage", frame, k) === 0)
        this.images(valueAt(run, "item_x", frame, k), valueAt(run, "item_y", frame, k), 0.2, (x, y) =>
          this.diamond(c, x, y, valueAt(run, "item_leftover", frame, k) ? size * LEFT : size));
    c.strokeStyle = colours.ink;
    c.lineWidth = 1;
    c.fill();
    c.stroke();
  }

  /** @param {CanvasRenderingContext2D} c @param {number} frame @param {number} chosen @param {Colours} colours */
  drawPaths(c, frame, chosen, colours) {
    const { run } = this, { width, height, robots, period } = run.head;
    const x = run.tracks.get("x")?.room, y = run.tracks.get("y")?.room;
    if (!x || !y) return;
    const begin = Math.max(0, frame - Math.round(PATH_SECONDS / period));
    /** @param {number} i @param {number} step */
    const path = (i, step) => {
      c.beginPath(); // one stroke for each path: a single one for all takes far longer
      let [bx, by] = this.place(x[begin * robots + i] / 1000, y[begin * robots + i] / 1000);
      c.moveTo(bx, by);
      const w = (width * this.scale) / 2, h = (height * this.scale) / 2;
      for (let t = begin + step; t <= frame + step - 1; t += step) {
        const at = Math.min(t, frame) * robots + i;
        const [px, py] = this.place(x[at] / 1000, y[at] / 1000);
        if (Math.abs(px - bx) > w || Math.abs(py - by) > h) c.moveTo(px, py);
        else c.lineTo(px, py);
        [bx, by] = [px, py];
      }
      c.stroke();
    };
    c.strokeStyle = colours.faint;
    c.lineWidth = 1;
    if (robots <= MOST_PATHS) for (const i of this.rows) if (i !== chosen) path(i, 2);
    c.strokeStyle = colours.ink;
    c.lineWidth = 2;
    if (this.rows.includes(chosen)) path(chosen, 1);
  }

  /** @param {CanvasRenderingContext2D} c @param {number} frame @param {number} chosen @param {Colours} colours */
  drawSeen(c, frame, chosen, colours) {
    const { width, height } = this.run.head, s = this.scale;
    const pairs = seenPairs(this.run, frame, this.x, this.y, this.rows);
    for (const own of [false, true]) {
      c.strokeStyle = own ? colours.ink : faded(colourOf(0), 0.4);
      c.lineWidth = own ? 1.8 : 1;
      c.beginPath();
      for (let p = 0; p < pairs.length; p += 2) {
        const [i, j] = [pairs[p], pairs[p + 1]];
        if ((i === chosen) !== own) continue;
        const [x, y] = this.place(this.x[i], this.y[i]);
        c.moveTo(x, y);
        c.lineTo(x + (shorter(this.x[j] - this.x[i], width) * s) / 2, y - (shorter(this.y[j] - this.y[i], height) * s) / 2);
      }
      c.stroke();
    }
  }

  /** @param {CanvasRenderingContext2D} c @param {number} frame @param {number} chosen @param {Layers} layers */
  drawReach(c, frame, chosen, layers) {
    const { run } = this;
    const name = Object.keys(run.head.options)[0], s = this.scale;
    const rows = run.head.robots > MOST_PATHS ? this.rows.filter((i) => i === chosen) : this.rows;
    for (const i of rows) {
      const own = i === chosen, goal = settingOf(run, i, "pose_goal_radius"), diffusion = settingOf(run, i, "pose_diffusion");
      const view = run.head.views[name]?.[valueAt(run, `held/${name}`, frame, i)] ?? 0;
      this.images(this.x[i], this.y[i], goal + Math.max(diffusion, view), (x, y) => {
        if (layers.reach) {
          c.fillStyle = faded(LOOK.repels, own ? 0.1 : 0.05);
          c.beginPath();
          c.arc(x, y, (goal + diffusion) * s, 0, 7);
          c.fill();
          c.strokeStyle = faded(LOOK.repels, 0.4);
          c.lineWidth = 1;
          c.beginPath();
          c.arc(x, y, goal * s, 0, 7);
          c.stroke();
        }
        if (layers.view) {
          c.strokeStyle = faded(colourOf(0), own ? 1 : 0.3);
          c.lineWidth = own ? 1.5 : 1;
          c.beginPath();
          c.arc(x, y, (goal + view) * s, 0, 7);
          c.stroke();
        }
      });
    }
  }

  /** @param {CanvasRenderingContext2D} c @param {number} frame @param {number} chosen @param {Layers} layers @param {Colours} colours */
  drawRobots(c, frame, chosen, layers, colours) {
    const { run } = this, { options, models } = run.head, s = this.scale;
    const goal = Object.keys(options)[0], radii = Array.from(this.x, (_, i) => settingOf(run, i, "radius"));
    const sizes = radii.map((radius) => Math.max(2, radius * s)), largest = Math.max(...sizes);
    /** @type {Map<string, [number, number, number][]>} */
    const groups = new Map();
    for (const i of this.rows) {
      const colour = valueAt(run, "working", frame, i) ? colourOf(valueAt(run, `held/${goal}`, frame, i)) : LOOK.failed.colour;
      const group = groups.get(colour) ?? [];
      groups.set(colour, group);
      this.images(this.x[i], this.y[i], radii[i], (x, y) => group.push([x, y, i]));
    }
    if (largest < SMALL) return this.drawSquares(c, frame, chosen, layers, colours, groups);
    c.strokeStyle = colours.paper;
    c.lineWidth = 1;
    for (const [colour, group] of groups) {
      c.fillStyle = colour;
      c.beginPath();
      for (const [x, y, i] of group) { c.moveTo(x + sizes[i], y); c.arc(x, y, sizes[i], 0, 7); }
      c.fill();
      c.stroke();
    }
    const all = [...groups.values()].flat();
    c.fillStyle = "#fff";
    c.beginPath();
    for (const [x, y, i] of all) {
      const turn = -this.turn[i];
      c.moveTo(x, y);
      c.arc(x, y, LOOK.front_length * sizes[i], turn - LOOK.front_angle, turn + LOOK.front_angle);
      c.closePath();
    }
    if (models) for (const [x, y, i] of all) this.mark(c, LOOK.marks[models[i] % LOOK.marks.length], x, y, LOOK.mark_half * sizes[i]);
    c.fill();
    c.beginPath();
    for (const [x, y, i] of all)
      if (run.tracks.has("cargo") && valueAt(run, "cargo", frame, i) >= 0)
        this.diamond(c, x - Math.cos(this.turn[i]) * LOOK.cargo_behind * sizes[i], y + Math.sin(this.turn[i]) * LOOK.cargo_behind * sizes[i],
          LOOK.cargo_half * sizes[i] * (valueAt(run, "recycled", frame, i) ? LEFT : 1));
    c.fillStyle = LOOK.item.colour;
    c.strokeStyle = LOOK.ink;
    c.fill();
    c.stroke();
    if (layers.contacts) {
      c.strokeStyle = LOOK.contact;
      c.lineWidth = 3;
      c.beginPath();
      for (const [x, y, i] of all) if (valueAt(run, "contact", frame, i) > 0) { c.moveTo(x + sizes[i] + 3, y); c.arc(x, y, sizes[i] + 3, 0, 7); }
      c.stroke();
    }
    c.strokeStyle = colours.ink;
    c.lineWidth = 3;
    for (const [x, y, i] of all)
      if (i === chosen) {
        c.beginPath();
        c.arc(x, y, sizes[i] + 2, 0, 7);
        c.stroke();
      }
    if (layers.numbers && (this.rows.length <= LOOK.most_numbered || this.zoom > 2) && Math.min(...sizes) > LOOK.least_numbered) {
      c.fillStyle = colours.ink;
      c.strokeStyle = colours.paper;
      c.lineWidth = 2;
      c.font = `600 ${LOOK.letter_size}px sans-serif`;
      c.lineWidth = 3;
      c.textAlign = "left";
      c.textBaseline = "alphabetic";
      for (const [x, y, i] of all) {
        c.strokeText(String(i), x + sizes[i] + 1, y - sizes[i]);
        c.fillText(String(i), x + sizes[i] + 1, y - sizes[i]);
      }
    }
  }

  /** Add the mark of a model to the path. @param {CanvasRenderingContext2D} c @param {string} shape @param {number} x @param {number} y @param {number} half */
  mark(c, shape, x, y, half) {
    if (shape === "square") c.rect(x - half, y - half, 2 * half, 2 * half);
    if (shape === "diamond") this.diamond(c, x, y, half);
    if (shape === "disc") { c.moveTo(x + half, y); c.arc(x, y, half, 0, 7); }
  }

  /**
   * Draw robots that are too small for discs.
   * @param {CanvasRenderingContext2D} c @param {number} frame @param {number} chosen @param {Layers} layers @param {Colours} colours
   * @param {Map<string, [number, number, number][]>} groups places and numbers by colour
   */
  drawSquares(c, frame, chosen, layers, colours, groups) {
    for (const [colour, group] of groups) {
      c.fillStyle = colour;
      for (const [x, y] of group) c.fillRect(Math.round(x) - 2, Math.round(y) - 2, 5, 5);
    }
    for (const group of groups.values())
      for (const [x, y, i] of group) {
        if (layers.contacts && valueAt(this.run, "contact", frame, i) > 0) {
          c.fillStyle = LOOK.contact;
          c.fillRect(Math.round(x) - 3, Math.round(y) + 4, 7, 2);
        }
        if (this.run.tracks.has("cargo") && valueAt(this.run, "cargo", frame, i) >= 0) {
          c.fillStyle = LOOK.item.colour;
          c.fillRect(Math.round(x) - 1, Math.round(y) - 1, 3, 3);
        }
        if (i === chosen) {
          c.strokeStyle = colours.ink;
          c.lineWidth = 2;
          c.strokeRect(Math.round(x) - 5, Math.round(y) - 5, 11, 11);
        }
      }
  }
}
