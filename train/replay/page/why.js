// @ts-check
/** Why a robot moves as it does: facts of a frame, one sentence made of them by rules, and arrows in the world. */
import { placesOf, valueAt } from "./recording.js";
import { shorter } from "./course.js";
import { LOOK } from "./look.js";
/** @typedef {import("./recording.js").Run} Run */
/** @typedef {import("./world.js").WorldView} WorldView */
/**
 * What the sentence is made of; `train/evaluation/why.py` has the same facts and the same rules. wish, command: [m/s]; heading [rad];
 * causes: robot and distance [m]; share: of the second cause; target: word and distance [m], -1 if it is not known; unseen: time
 * since the robot last saw what it looks for, -1 for one that looks for nothing [s].
 * @typedef {{state: string, stands: number, running: string[], wish: [number, number], command: [number, number], heading: number,
 *   causes: [number, number][], share: number, target: [string, number] | null, unseen: number}} Facts
 */

const STRAIGHT = 0.17; // [rad] up to which a robot goes straight on, ten degrees
const SLOW = 0.05; // [m/s] that a difference of speeds must have to count
const COUNTS = 0.25; // share from which a second neighbour is named
const LEAST_LINE = 33; // length from which a line to a neighbour has its share beside it [pixels]
const AVOIDS = "AvoidCollision";

/** Return the sensor's reading of the robot's network; NaN if there is none. @param {Run} run @param {string} name @param {number} frame @param {number} robot */
function reading(run, name, frame, robot) {
  const sensors = run.head.networks?.robot.sensors ?? [], k = sensors.indexOf(name);
  return k < 0 ? NaN : valueAt(run, "robot/readings", frame, robot * sensors.length + k);
}

/** Return where a robot wants to go, by what it reads: word, place and distance [m]; null without a target. @param {Run} run @param {number} frame @param {number} robot */
export function targetOf(run, frame, robot) {
  const { width, height, destinations = [] } = run.head, x = valueAt(run, "x", frame, robot), y = valueAt(run, "y", frame, robot);
  const one = destinations.find(({ when }) => Object.entries(when).every(([sensor, wanted]) => reading(run, sensor, frame, robot) > 0 === wanted));
  const places = one ? placesOf(run, one, frame) : [], far = places.map(([px, py]) => Math.hypot(shorter(px - x, width), shorter(py - y, height)));
  if (!one || !places.length) return null;
  const [px, py] = places[far.indexOf(Math.min(...far))], place = /** @type {[number, number]} */ ([px, py]);
  return { word: one.word, place, distance: one.certain ? Math.min(...far) : -1 };
}

/** Return the facts about a robot at a frame. @param {Run} run @param {number} frame @param {number} robot @returns {Facts} */
export function factsOf(run, frame, robot) {
  const { head } = run, behaviours = head.networks?.robot.behaviours ?? [], most = causesOf(run);
  const x = valueAt(run, "x", frame, robot), y = valueAt(run, "y", frame, robot), target = targetOf(run, frame, robot);
  const sees = head.task_words?.sees ?? "";
  /** @type {[number, number][]} */
  const causes = [];
  for (let k = 0; k < most; k++) {
    const who = valueAt(run, "cause", frame, robot * most + k);
    if (who >= 0) causes.push([who, Math.hypot(shorter(valueAt(run, "x", frame, who) - x, head.width), shorter(valueAt(run, "y", frame, who) - y, head.height))]);
  }
  let since = frame;
  while (since >= 0 && valueAt(run, "present", since, robot) && !(reading(run, sees, since, robot) > 0)) since--;
  return {
    state: valueAt(run, "working", frame, robot) ? "at work" : valueAt(run, "present", frame, robot) ? "failed" : "taken away",
    stands: valueAt(run, "standing", frame, robot) * head.period,
    running: behaviours.filter((_, b) => valueAt(run, "robot/running", frame, robot * behaviours.length + b)),
    wish: [valueAt(run, "wish_x", frame, robot), valueAt(run, "wish_y", frame, robot)],
    command: [valueAt(run, "command_x", frame, robot), valueAt(run, "command_y", frame, robot)],
    heading: valueAt(run, "heading", frame, robot),
    causes,
    share: most > 1 ? valueAt(run, "cause_share", frame, robot * most + 1) : 0,
    target: target && [target.word, target.distance],
    unseen: Number.isNaN(reading(run, sees, frame, robot)) ? -1 : (frame - since) * head.period,
  };
}

/** Return how many neighbours are kept for a robot. @param {Run} run */
const causesOf = (run) => (run.tracks.get("cause")?.columns ?? 0) / run.head.robots;

/** Return one sentence about what a robot does and because of whom, in the words of a task. @param {Facts} facts @param {import("./recording.js").TaskWords | undefined} words */
export function sentenceOf({ state, stands, running, wish, command, heading, causes, share, target, unseen }, { doing, searching } = { doing: {}, searching: {}, sees: "" }) {
  if (state !== "at work") return state === "failed" ? "does nothing: it has failed" : "is not there";
  if (stands > 0) return `stands after a collision, for ${stands.toFixed(1)} s more`;
  const to = target && (target[1] < 0 ? target[0] : `${target[0]}, ${target[1].toFixed(1)} m`);
  const [wanted, told] = [Math.hypot(...wish), Math.hypot(...command)];
  const heldUp = running.includes(AVOIDS) && told < SLOW; // avoiding holds it where it is
  if (causes.length && (heldUp || Math.hypot(command[0] - wish[0], command[1] - wish[1]) > SLOW)) {
    const before = wanted > SLOW ? Math.atan2(wish[1], wish[0]) : heading, turn = shorter(Math.atan2(command[1], command[0]) - before, 2 * Math.PI);
    const does = told < SLOW ? "stops" : turn > STRAIGHT ? "turns left" : turn < -STRAIGHT ? "turns right" : told < wanted - SLOW ? "slows down" : "keeps away";
    const who = `robot ${causes[0][0]}, ${causes[0][1].toFixed(1)} m away${causes.length > 1 && share >= COUNTS ? `, and robot ${causes[1][0]}` : ""}`;
    return `${does} because of ${who}; would ${to ? `go to ${to}` : Object.values(searching)[0] ?? "go on"}`;
  }
  const done = running.find((name) => name in doing), looking = running.find((name) => name in searching);
  if (done) return doing[done];
  if (to) return `goes to ${to}`;
  if (looking) return `${searching[looking]}s: nothing seen for ${unseen.toFixed(0)} s`;
  return running.length ? `runs ${running.join(" and ")}` : "does nothing: no behaviour runs";
}

/** Draw an arrow from a place. @param {CanvasRenderingContext2D} c @param {number} x @param {number} y @param {number} dx @param {number} dy @param {string} colour @param {number} width */
function arrow(c, x, y, dx, dy, colour, width) {
  const length = Math.hypot(dx, dy);
  if (length < 3) return;
  const head = Math.min(length, 4 + 2 * width), [ux, uy] = [dx / length, dy / length];
  c.strokeStyle = c.fillStyle = colour;
  c.lineWidth = width;
  c.beginPath();
  c.moveTo(x, y);
  c.lineTo(x + dx - ux * head, y + dy - uy * head);
  c.stroke();
  c.beginPath();
  c.moveTo(x + dx, y + dy);
  c.lineTo(x + dx - ux * head - uy * head * 0.5, y + dy - uy * head + ux * head * 0.5);
  c.lineTo(x + dx - ux * head + uy * head * 0.5, y + dy - uy * head - ux * head * 0.5);
  c.fill();
}

/**
 * Draw the commands of robots and what mechanisms add to them, and of the chosen robot its target and who counts.
 * @param {WorldView} view @param {number} frame @param {number} chosen @param {import("./look.js").Layers} layers @param {import("./look.js").Colours} colours
 */
export function drawWhy(view, frame, chosen, layers, colours) {
  const { run } = view, { width, height } = run.head, c = /** @type {CanvasRenderingContext2D} */ (view.canvas.getContext("2d")), s = view.scale;
  const colourOfLayer = Object.fromEntries(LOOK.layers.map(([name, { colour }]) => [name, colour])), most = causesOf(run);
  /** @param {number} i @param {number} x @param {number} y @returns {[number, number]} the way to a place by the torus [pixels] */
  const way = (i, x, y) => [shorter(x - view.x[i], width) * s, -shorter(y - view.y[i], height) * s];
  /** Words over the lines, with their places. @type {[string, number, number][]} */
  const shares = [];
  if (layers.causes && view.rows.includes(chosen))
    for (let k = 0; k < most; k++) {
      const who = valueAt(run, "cause", frame, chosen * most + k), share = valueAt(run, "cause_share", frame, chosen * most + k);
      if (who < 0) continue;
      const [x, y] = view.place(view.x[chosen], view.y[chosen]), [dx, dy] = way(chosen, view.x[who], view.y[who]);
      c.strokeStyle = colourOfLayer.causes;
      c.lineWidth = 1 + 5 * share;
      c.beginPath();
      c.moveTo(x, y);
      c.lineTo(x + dx, y + dy);
      c.stroke();
      if (Math.hypot(dx, dy) > LEAST_LINE) shares.push([`${Math.round(100 * share)} %`, x + 0.6 * dx, y + 0.6 * dy - 4]);
    }
  const target = layers.target ? targetOf(run, frame, chosen) : null;
  if (target && target.distance >= 0 && view.rows.includes(chosen)) {
    c.setLineDash([5, 4]);
    arrow(c, ...view.place(view.x[chosen], view.y[chosen]), ...way(chosen, ...target.place), colourOfLayer.target, 2);
    c.setLineDash([]);
  }
  for (const i of layers.command || layers.added ? view.rows : []) {
    const [x, y] = view.place(view.x[i], view.y[i]), width = i === chosen ? 3 : 1.5;
    const [vx, vy] = [valueAt(run, "command_x", frame, i), valueAt(run, "command_y", frame, i)];
    const [wx, wy] = [valueAt(run, "wish_x", frame, i), valueAt(run, "wish_y", frame, i)];
    if (layers.added && i === chosen && valueAt(run, "cause", frame, i * most) >= 0) arrow(c, x + wx * s, y - wy * s, (vx - wx) * s, -(vy - wy) * s, colourOfLayer.added, width);
    if (layers.command) arrow(c, x, y, vx * s, -vy * s, colours.ink, width);
  }
  c.font = `600 ${LOOK.letter_size}px sans-serif`;
  c.textAlign = "center";
  c.lineWidth = 3;
  c.strokeStyle = colours.paper;
  c.fillStyle = colours.ink;
  for (const [words, x, y] of shares) {
    const inside = Math.max(18, Math.min(view.wide - 18, x)), below = Math.max(LOOK.letter_size, y);
    c.strokeText(words, inside, below);
    c.fillText(words, inside, below);
    view.numbers.push([inside, below - LOOK.letter_size / 3, 14]);
  }
}
