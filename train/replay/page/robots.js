// @ts-check
/** Robots, and what shows their movement and what they see. */
import { loadOf, settingOf, valueAt } from "./recording.js";
import { seenPairs, shorter } from "./course.js";
import { LOOK, colourOf, faded } from "./look.js";
import { SMALL, shape } from "./floor.js";
/** @typedef {import("./world.js").WorldView} WorldView */
/** @typedef {import("./look.js").Colours} Colours */
/** @typedef {import("./look.js").Layers} Layers */

const PATH_SECONDS = 20;
const MOST_PATHS = 60; // robots up to which all paths are drawn, and all reaches; of larger teams the chosen robot's
const LEAST_LETTER = 9; // height of the numbers of robots that are small [pixels]
const CORNERS = 8; // of a robot, at which its number can stand: right above it first

/** @param {WorldView} view @param {CanvasRenderingContext2D} c @param {number} frame @param {number} chosen @param {Colours} colours */
export function drawPaths(view, c, frame, chosen, colours) {
  const { run } = view, { width, height, robots, period } = run.head;
  const x = run.tracks.get("x")?.room, y = run.tracks.get("y")?.room;
  if (!x || !y) return;
  const begin = Math.max(0, frame - Math.round(PATH_SECONDS / period));
  /** @param {number} i @param {number} step */
  const path = (i, step) => {
    c.beginPath(); // one stroke for each path: a single one for all takes far longer
    let [bx, by] = view.place(x[begin * robots + i] / 1000, y[begin * robots + i] / 1000);
    c.moveTo(bx, by);
    const w = (width * view.scale) / 2, h = (height * view.scale) / 2;
    for (let t = begin + step; t <= frame + step - 1; t += step) {
      const at = Math.min(t, frame) * robots + i;
      const [px, py] = view.place(x[at] / 1000, y[at] / 1000);
      if (Math.abs(px - bx) > w || Math.abs(py - by) > h) c.moveTo(px, py);
      else c.lineTo(px, py);
      [bx, by] = [px, py];
    }
    c.stroke();
  };
  c.strokeStyle = colours.faint;
  c.lineWidth = 1;
  if (robots <= MOST_PATHS) for (const i of view.rows) if (i !== chosen) path(i, 2);
  c.strokeStyle = colours.ink;
  c.lineWidth = 2;
  if (view.rows.includes(chosen)) path(chosen, 1);
}

/** @param {WorldView} view @param {CanvasRenderingContext2D} c @param {number} frame @param {number} chosen @param {Colours} colours */
export function drawSeen(view, c, frame, chosen, colours) {
  const { width, height } = view.run.head, s = view.scale;
  const pairs = seenPairs(view.run, frame, view.x, view.y, view.rows);
  for (const own of [false, true]) {
    c.strokeStyle = own ? colours.ink : faded(colourOf(0), 0.4);
    c.lineWidth = own ? 1.8 : 1;
    c.beginPath();
    for (let p = 0; p < pairs.length; p += 2) {
      const [i, j] = [pairs[p], pairs[p + 1]];
      if ((i === chosen) !== own) continue;
      const [x, y] = view.place(view.x[i], view.y[i]);
      c.moveTo(x, y);
      c.lineTo(x + (shorter(view.x[j] - view.x[i], width) * s) / 2, y - (shorter(view.y[j] - view.y[i], height) * s) / 2);
    }
    c.stroke();
  }
}

/** @param {WorldView} view @param {CanvasRenderingContext2D} c @param {number} frame @param {number} chosen @param {Layers} layers */
export function drawReach(view, c, frame, chosen, layers) {
  const { run } = view;
  const name = Object.keys(run.head.options)[0], s = view.scale;
  const rows = run.head.robots > MOST_PATHS ? view.rows.filter((i) => i === chosen) : view.rows;
  for (const i of rows) {
    const own = i === chosen, goal = settingOf(run, i, "pose_goal_radius"), diffusion = settingOf(run, i, "pose_diffusion");
    const sight = run.head.views[name]?.[valueAt(run, `held/${name}`, frame, i)] ?? 0;
    view.images(view.x[i], view.y[i], goal + Math.max(diffusion, sight), (x, y) => {
      if (layers.reach) {
        c.fillStyle = faded(LOOK.areas[1].colour, own ? 0.1 : 0.05);
        c.beginPath();
        c.arc(x, y, (goal + diffusion) * s, 0, 7);
        c.fill();
        c.strokeStyle = faded(LOOK.areas[1].colour, 0.4);
        c.lineWidth = 1;
        c.beginPath();
        c.arc(x, y, goal * s, 0, 7);
        c.stroke();
      }
      if (layers.view) {
        c.strokeStyle = faded(colourOf(0), own ? 1 : 0.3);
        c.lineWidth = own ? 1.5 : 1;
        c.beginPath();
        c.arc(x, y, (goal + sight) * s, 0, 7);
        c.stroke();
      }
    });
  }
}

/** @param {WorldView} view @param {CanvasRenderingContext2D} c @param {number} frame @param {number} chosen @param {Layers} layers @param {Colours} colours */
export function drawRobots(view, c, frame, chosen, layers, colours) {
  const { run } = view, { models } = run.head, s = view.scale;
  const radii = Array.from(view.x, (_, i) => settingOf(run, i, "radius"));
  const least = view.rows.length <= MOST_PATHS ? SMALL + 1 : 2, sizes = radii.map((radius) => Math.max(least, radius * s)), largest = Math.max(...sizes);
  /** @type {Map<string, [number, number, number][]>} */
  const groups = new Map();
  for (const i of view.rows) {
    const colour = valueAt(run, "working", frame, i) ? colourOf(valueAt(run, `held/${run.goal}`, frame, i)) : LOOK.failed.colour;
    const group = groups.get(colour) ?? [];
    groups.set(colour, group);
    view.images(view.x[i], view.y[i], radii[i], (x, y) => group.push([x, y, i]));
  }
  if (largest < SMALL) return drawSquares(view, c, frame, chosen, layers, colours, groups);
  c.strokeStyle = colours.rim;
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
    const turn = -view.turn[i];
    c.moveTo(x, y);
    c.arc(x, y, LOOK.front_length * sizes[i], turn - LOOK.front_angle, turn + LOOK.front_angle);
    c.closePath();
  }
  if (models) for (const [x, y, i] of all) shape(c, LOOK.marks[models[i] % LOOK.marks.length], x, y, LOOK.mark_half * sizes[i]);
  c.fill();
  c.strokeStyle = LOOK.ink;
  for (const [name, sign] of Object.entries(LOOK.signs)) {
    const loaded = all.filter(([, , i]) => loadOf(run, frame, i) === name);
    if (!loaded.length) continue;
    c.fillStyle = sign.colour;
    c.beginPath();
    for (const [x, y, i] of loaded)
      shape(c, sign.shape, x - Math.cos(view.turn[i]) * LOOK.cargo_behind * sizes[i], y + Math.sin(view.turn[i]) * LOOK.cargo_behind * sizes[i],
        (LOOK.cargo_half * sizes[i] * sign.half) / LOOK.item.half);
    c.fill();
    c.stroke();
  }
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
  view.discs = all.map(([x, y, i]) => [x, y, sizes[i], i]);
}

/**
 * Draw robots that are too small for discs.
 * @param {WorldView} view @param {CanvasRenderingContext2D} c @param {number} frame @param {number} chosen @param {Layers} layers @param {Colours} colours
 * @param {Map<string, [number, number, number][]>} groups places and numbers by colour
 */
function drawSquares(view, c, frame, chosen, layers, colours, groups) {
  for (const [colour, group] of groups) {
    c.fillStyle = colour;
    for (const [x, y] of group) c.fillRect(Math.round(x) - 2, Math.round(y) - 2, 5, 5);
  }
  for (const group of groups.values())
    for (const [x, y, i] of group) {
      if (layers.contacts && valueAt(view.run, "contact", frame, i) > 0) {
        c.fillStyle = LOOK.contact;
        c.fillRect(Math.round(x) - 3, Math.round(y) + 4, 7, 2);
      }
      const load = loadOf(view.run, frame, i);
      if (load) {
        c.fillStyle = LOOK.signs[load].colour;
        c.fillRect(Math.round(x) - 1, Math.round(y) - 1, 3, 3);
      }
      if (i === chosen) {
        c.strokeStyle = colours.ink;
        c.lineWidth = 2;
        c.strokeRect(Math.round(x) - 5, Math.round(y) - 5, 11, 11);
      }
    }
}

/**
 * Write the number of each robot beside it: where there is most room, at the corner of the picture before if that has as much.
 * @param {WorldView} view @param {CanvasRenderingContext2D} c @param {Colours} colours
 */
export function drawNumbers(view, c, colours) {
  const largest = Math.max(...view.discs.map(([, , size]) => size)), high = largest > LOOK.least_numbered ? LOOK.letter_size : LEAST_LETTER;
  c.fillStyle = colours.ink;
  c.strokeStyle = colours.paper;
  c.font = `600 ${high}px sans-serif`;
  c.lineWidth = 3;
  c.textAlign = "center";
  c.textBaseline = "middle";
  const written = view.numbers, widest = 0.3 * high * String(view.run.head.robots).length;
  for (const [x, y, size, i] of view.discs) {
    const half = 0.3 * high * String(i).length, far = size + 2 + 2 * half + 2 * high + largest + widest;
    /** @template {number[]} T @param {T[]} all @returns {T[]} those that a number of this robot may cover */
    const near = (all) => all.filter(([ox, oy]) => Math.abs(ox - x) < far && Math.abs(oy - y) < far);
    const discs = near(view.discs), before = near(written);
    /** How much a number at a corner would cover. @param {number} corner */
    const covered = (corner) => {
      const [px, py] = besideOf(x, y, size, corner, half, high);
      let sum = px < half || px > view.wide - half || py < high / 2 || py > view.high - high / 2 ? 1 : 0;
      for (const [ox, oy, wide, other] of discs)
        if (other !== i) sum += Math.max(0, wide - Math.hypot(Math.max(0, Math.abs(px - ox) - half), Math.max(0, Math.abs(py - oy) - high / 2)));
      for (const [ox, oy, wide] of before) sum += 2 * Math.max(0, wide + half - Math.abs(px - ox)) * (Math.abs(py - oy) < high ? 1 : 0);
      return sum;
    };
    let best = view.corners[i], least = covered(best);
    for (let corner = 0; corner < CORNERS && least > 0; corner++) {
      const own = covered(corner);
      if (own < least) [best, least] = [corner, own];
    }
    view.corners[i] = best;
    const [px, py] = besideOf(x, y, size, best, half, high);
    written.push([px, py, half]);
    c.strokeText(String(i), px, py);
    c.fillText(String(i), px, py);
  }
  c.textBaseline = "alphabetic";
}

/** Return the middle of a number at one of eight corners of a robot. @param {number} x @param {number} y @param {number} size @param {number} corner @param {number} half @param {number} high @returns {[number, number]} */
function besideOf(x, y, size, corner, half, high) {
  const angle = ((2 * corner + 1) * Math.PI) / 4 + (corner >= 4 ? Math.PI / 4 : 0);
  return [x + Math.cos(angle) * (size + 1 + half), y - Math.sin(angle) * (size + 1 + high / 2)];
}
