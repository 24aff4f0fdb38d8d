// @ts-check
/** What follows from a recording: events, counts, who sees whom, and what robots have left behind. */
import { loadOf, settingOf, valueAt } from "./recording.js";
import { WORDS } from "./words.js";
/** @typedef {import("./recording.js").Run} Run */
/** @typedef {{frame: number, kind: string, robot: number}} RunEvent */
/** @typedef {{items: number[], contacts: number[]}} Counts up to each frame */

/** Kinds of events of all tasks, with their words, in the order of the timeline's lines. */
const EVENT_WORDS = {
  found: "item found", recycled: "item recycled", dumped: "item dumped", put: "item put down", contact: "contact",
  switch: "option switched", replan: "new plan", joined: "robot joined",
  failed: "robot failed or left", hand: "done by hand",
};

/** Return the kinds of events, each with its word and what it is: those of tasks themselves first. @param {Run[]} runs @returns {Map<string, [string, string]>} */
export const kindsOf = (runs) => new Map([
  ...runs.flatMap((run) => run.head.events ?? []).map(({ event, about }) => /** @type {[string, [string, string]]} */ ([event, [event, about]])),
  ...Object.entries(EVENT_WORDS).map(([kind, word]) => /** @type {[string, [string, string]]} */ ([kind, [word, WORDS[kind]]])),
]);

/** Return all events, in the order of time. @param {Run} run @returns {RunEvent[]} */
export function eventsOf(run) {
  /** @type {RunEvent[]} */
  const events = [];
  const robots = run.head.robots;
  /** @param {string} name @param {(was: number, is: number, at: number) => string} kindOf @param {boolean} [begins] whether numbers were 0 before the first frame */
  const watch = (name, kindOf, begins = false) => {
    const track = run.tracks.get(name);
    if (!track) return;
    const { columns, channel } = track, own = channel.axes[0] === "robot";
    for (let at = begins ? 0 : columns; at < track.data.length; at++) {
      const kind = kindOf(track.data[at - columns] ?? 0, track.data[at], at);
      if (kind) events.push({ frame: Math.floor(at / columns), kind, robot: own ? at % columns : -1 });
    }
  };
  if (run.head.drawn?.some(({ at }) => at === "robot")) carriedOf(run, events);
  for (const { of, event } of run.head.events ?? []) watch(of, (was, is) => (is > was ? event : ""), true);
  watch("contact", (_, is) => (is > 0 ? "contact" : ""));
  watch("working", (was, is) => (is > was ? "joined" : is < was ? "failed" : ""));
  for (const goal of Object.keys(run.head.options)) watch(`held/${goal}`, (was, is) => (was !== is ? "switch" : ""));
  const plan = run.tracks.get("robot/plan"), length = run.tracks.get("robot/plan_length");
  if (plan && length) {
    const steps = plan.columns / robots;
    watch("robot/plan_length", (was, is, at) => {
      let same = was === is;
      for (let k = 0; same && k < is; k++) same = plan.data[at * steps + k] === plan.data[(at - robots) * steps + k];
      return same || is < 0 ? "" : "replan";
    });
  }
  for (const change of [...run.byHand, ...run.coming]) events.push({ frame: change.tick, kind: "hand", robot: change.robot ?? change.robots?.[0] ?? -1 });
  return events.sort((a, b) => a.frame - b.frame);
}

/** Add when robots took, changed and put down what they carry; those that put down where things become done have done these. @param {Run} run @param {RunEvent[]} events */
function carriedOf(run, events) {
  let before = Array.from({ length: run.head.robots }, (_, robot) => loadOf(run, 0, robot));
  for (let frame = 1; frame < run.frames; frame++) {
    const now = before.map((_, robot) => loadOf(run, frame, robot)), done = valueAt(run, "dumped", frame) - valueAt(run, "dumped", frame - 1);
    /** @type {number[]} */
    const put = [];
    now.forEach((load, robot) => {
      if (load === before[robot]) return;
      if (!load) put.push(robot);
      else events.push({ frame, kind: before[robot] ? "recycled" : "found", robot });
    });
    for (let k = 0; k < done; k++) events.push({ frame, kind: "dumped", robot: put[k] ?? put[0] ?? -1 });
    if (!run.tracks.has("dumped")) for (const robot of put) events.push({ frame, kind: "put", robot });
    before = now;
  }
}

/** Count items dumped and collision events up to each frame that has come since. @param {Run} run @param {Counts} counts */
export function countMore(run, { items, contacts }) {
  const { robots } = run.head, contact = run.tracks.get("contact")?.data;
  for (let t = items.length; t < run.frames; t++) {
    let touched = 0;
    for (let k = 0; contact && k < robots; k++) touched += contact[t * robots + k];
    items.push(valueAt(run, "dumped", t));
    contacts.push((contacts[t - 1] ?? 0) + touched / 2);
  }
}

/** Return what robots held in all frames, the present too. @param {Run} run @param {string} goal @returns {Int32Array} */
function heldUntil(run, goal) {
  const track = run.tracks.get(`held/${goal}`);
  return track ? track.room.subarray(0, (run.frames + run.ahead) * track.columns) : new Int32Array(0);
}

/** Return the numbers of the options of a goal that robots have held. @param {Run} run @param {string} goal */
export const everHeld = (run, goal) => [...new Set(heldUntil(run, goal))].filter((k) => k >= 0).sort((a, b) => a - b);

/** Return the goal whose options are worth colours: the first one, unless only those of a later one differ. @param {Run[]} runs */
export function goalShown(runs) {
  const goals = Object.keys(runs[0].head.options);
  return goals.find((goal) => new Set(runs.flatMap((run) => everHeld(run, goal).map((k) => run.head.options[goal]?.[k]))).size > 1) ?? goals[0] ?? "";
}

/** Return the first frame at which robots of two runs are at different places; -1 if there is none. @param {Run} a @param {Run} b */
export function partingFrame(a, b) {
  const names = ["x", "y", "heading"];
  const frames = Math.min(a.frames, b.frames), robots = a.head.robots;
  if (b.head.robots !== robots) return 0;
  for (let at = 0; at < frames * robots; at++)
    for (const name of names)
      if (a.tracks.get(name)?.data[at] !== b.tracks.get(name)?.data[at]) return Math.floor(at / robots);
  return a.frames === b.frames ? -1 : frames;
}

/** Return a difference of coordinates on the torus, by the shorter way. @param {number} d @param {number} extent */
export const shorter = (d, extent) => d - extent * Math.round(d / extent);

/**
 * Return pairs [who, whom] of robots that see each other's gradient: the goal area of the other is within the view.
 * @param {Run} run @param {number} frame @param {Float64Array} x @param {Float64Array} y @param {number[]} rows
 * @returns {number[]}
 */
export function seenPairs(run, frame, x, y, rows) {
  const { width, height } = run.head;
  const goal = Object.keys(run.head.options)[0];
  const views = run.head.views[goal] ?? [0];
  const radii = Array.from(x, (_, i) => settingOf(run, i, "pose_goal_radius"));
  const most = Math.max(...views) + Math.max(...radii);
  const nx = Math.max(1, Math.min(256, Math.floor(width / most))), ny = Math.max(1, Math.min(256, Math.floor(height / most)));
  const heads = new Int32Array(nx * ny).fill(-1), next = new Int32Array(x.length).fill(-1);
  /** @param {number} i @returns {[number, number]} */
  const cellOf = (i) => [Math.min(nx - 1, Math.floor((x[i] / width) * nx)), Math.min(ny - 1, Math.floor((y[i] / height) * ny))];
  for (const i of rows) {
    const [cx, cy] = cellOf(i), cell = cy * nx + cx;
    next[i] = heads[cell];
    heads[cell] = i;
  }
  /** @type {number[]} */
  const pairs = [];
  for (const i of rows) {
    const view = views[valueAt(run, `held/${goal}`, frame, i)] ?? 0;
    const [cx, cy] = cellOf(i);
    for (let ax = nx < 3 ? 0 : cx - 1; ax <= (nx < 3 ? nx - 1 : cx + 1); ax++)
      for (let ay = ny < 3 ? 0 : cy - 1; ay <= (ny < 3 ? ny - 1 : cy + 1); ay++)
        for (let j = heads[((ay + ny) % ny) * nx + ((ax + nx) % nx)]; j >= 0; j = next[j]) {
          if (j === i) continue;
          const reach = view + radii[j], dx = shorter(x[j] - x[i], width), dy = shorter(y[j] - y[i], height);
          if (dx * dx + dy * dy <= reach * reach) pairs.push(i, j);
        }
  }
  return pairs;
}

/** The field of what robots have left behind, on a grid of cells. */
export class Field {
  /** @param {Run} run */
  constructor(run) {
    this.run = run;
    const { width, height } = run.head;
    const cell = Math.max(0.1, Math.max(width, height) / 160);
    this.nx = Math.max(3, Math.round(width / cell));
    this.ny = Math.max(3, Math.round(height / cell));
    /** For each kind of deposits the frame in which each cell got one last. @type {Int32Array[]} */
    this.latest = [];
    this.reach = new Float32Array(this.nx * this.ny);
    this.shown = -1;
  }

  /** Return how far each cell is from the end of the traces at a frame, as a share of a fresh trace. @param {number} frame */
  at(frame) {
    const { run, reach } = this, { width, height, robots, period } = run.head;
    const deposit = run.tracks.get("deposit")?.data, x = run.tracks.get("x")?.data, y = run.tracks.get("y")?.data;
    if (!deposit || !x || !y || this.shown === frame) return reach;
    const from = this.shown >= 0 && this.shown < frame ? this.shown : 0;
    while (this.latest.length < run.deposits.length) this.latest.push(new Int32Array(this.nx * this.ny).fill(-1));
    if (!from) for (const latest of this.latest) latest.fill(-1);
    for (let t = from; t < frame; t++)
      for (let at = t * robots; at < (t + 1) * robots; at++)
        if (deposit[at]) {
          const cx = Math.min(this.nx - 1, Math.floor((x[at] / 1000 / width) * this.nx));
          const cy = Math.min(this.ny - 1, Math.floor((y[at] / 1000 / height) * this.ny));
          for (let k = 0; k < this.latest.length; k++) if (deposit[at] & (1 << k)) this.latest[k][cy * this.nx + cx] = t;
        }
    this.shown = frame;
    reach.fill(0);
    run.deposits.forEach((kind, k) => {
      for (let cell = 0; cell < reach.length; cell++) {
        const made = this.latest[k][cell];
        if (made < 0) continue;
        const periods = kind.evaporation_period > 0 ? Math.floor(((frame - made) * period) / kind.evaporation_period + 1e-6) : 0;
        const left = kind.diffusion * kind.evaporation_factor ** periods;
        if (left >= kind.min_diffusion && left > reach[cell]) reach[cell] = left;
      }
    });
    this.spread(width / this.nx, height / this.ny);
    return reach;
  }

  /** Give every cell the largest reach that is left of any other, after the way between them. @param {number} dx @param {number} dy */
  spread(dx, dy) {
    const { nx, ny, reach } = this, across = Math.hypot(dx, dy);
    /** @param {number} cell @param {number} cx @param {number} cy @param {number} way */
    const take = (cell, cx, cy, way) => {
      const left = reach[((cy + ny) % ny) * nx + ((cx + nx) % nx)] - way;
      if (left > reach[cell]) reach[cell] = left;
    };
    for (let round = 0; round < 2; round++) {
      for (let cy = 0; cy < ny; cy++)
        for (let cx = 0; cx < nx; cx++) {
          const cell = cy * nx + cx;
          take(cell, cx - 1, cy, dx); take(cell, cx, cy - 1, dy); take(cell, cx - 1, cy - 1, across); take(cell, cx + 1, cy - 1, across);
        }
      for (let cy = ny - 1; cy >= 0; cy--)
        for (let cx = nx - 1; cx >= 0; cx--) {
          const cell = cy * nx + cx;
          take(cell, cx + 1, cy, dx); take(cell, cx, cy + 1, dy); take(cell, cx + 1, cy + 1, across); take(cell, cx - 1, cy + 1, across);
        }
    }
  }
}
