// @ts-check
/** Charts of runs over time, and the timeline with events. */
import { valueAt } from "./recording.js";
import { LOOK, colourOf } from "./look.js";
/** @typedef {import("./recording.js").Run} Run */
/** @typedef {import("./course.js").RunEvent} RunEvent */

/** Return the context of a canvas that has been cleared. @param {HTMLCanvasElement} canvas */
function cleared(canvas) {
  const c = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  c.clearRect(0, 0, canvas.width, canvas.height);
  return c;
}

/** Draw the option that each robot holds over time. @param {Run} run @param {number} frames over the width @param {HTMLCanvasElement} canvas */
export function drawHeld(run, frames, canvas) {
  const c = cleared(canvas), { width, height } = canvas, robots = run.head.robots;
  const lines = Math.min(robots, height);
  for (let px = 0; px < width; px++) {
    const frame = Math.floor((px / width) * frames);
    if (frame >= run.frames) break;
    for (let line = 0; line < lines; line++) {
      const robot = Math.floor((line / lines) * robots);
      if (!valueAt(run, "present", frame, robot)) continue;
      c.fillStyle = valueAt(run, "working", frame, robot) ? colourOf(valueAt(run, `held/${run.goal}`, frame, robot)) : LOOK.failed.colour;
      c.fillRect(px, (line * height) / lines, 1, Math.max(1, height / lines - (robots > 40 ? 0 : 1)));
    }
  }
}

/** Draw curves over time. @param {{values: ArrayLike<number>, colour: string, dash?: number[], most: number, least?: number}[]} curves @param {number} frames @param {HTMLCanvasElement} canvas */
export function drawCurves(curves, frames, canvas) {
  const c = cleared(canvas), { width, height } = canvas;
  for (const { values, colour, dash, most, least } of curves) {
    c.strokeStyle = colour;
    c.lineWidth = 2;
    c.setLineDash(dash ?? []);
    c.beginPath();
    for (let px = 0; px < width; px++) {
      const frame = Math.floor((px / width) * frames);
      if (frame >= values.length) break;
      const low = least ?? 0;
      c.lineTo(px, height - 3 - ((values[frame] - low) / Math.max(most - low, 1e-9)) * (height - 6));
    }
    c.stroke();
  }
}

/** Return the opinion on each option, averaged over the robots, as one curve of `points` points each. @param {Run} run @param {number} points */
export function opinionCurves(run, points) {
  const { goal } = run, track = run.tracks.get(`opinion/${goal}`);
  if (!track) return [];
  const options = run.head.options[goal].length, robots = run.head.robots;
  const curves = run.head.options[goal].map((_, k) => ({ values: new Float64Array(run.frames), colour: colourOf(k), most: 0, least: 0 }));
  const step = Math.max(1, Math.floor(run.frames / points));
  for (let begin = 0; begin < run.frames; begin += step)
    for (let k = 0; k < options; k++) {
      let sum = 0;
      for (let i = 0; i < robots; i++) sum += track.data[(begin * robots + i) * options + k];
      curves[k].values.fill(sum / robots / track.channel.scale, begin, begin + step);
    }
  const most = Math.max(...curves.map((curve) => curve.values.reduce((a, b) => Math.max(a, b), 0)));
  const least = Math.min(0, ...curves.map((curve) => curve.values.reduce((a, b) => Math.min(a, b), 0)));
  for (const curve of curves) [curve.most, curve.least] = [most, least];
  return curves;
}

const EVENT_COLOURS = Object.entries({ found: LOOK.signs.item.colour, recycled: LOOK.signs.recycling.colour, dumped: LOOK.signs.dump.colour, put: LOOK.signs.dump.colour, contact: LOOK.contact });

/** Draw events: a line for each of some kinds. @param {RunEvent[]} events @param {string[]} kinds @param {number} frames @param {HTMLCanvasElement} canvas @param {string} ink */
export function drawEvents(events, kinds, frames, canvas, ink) {
  const c = cleared(canvas), { width, height } = canvas, line = height / kinds.length;
  kinds.forEach((kind, k) => {
    c.fillStyle = EVENT_COLOURS.find(([own]) => own === kind)?.[1] ?? (kind === "failed" ? ink : LOOK.edge);
    for (const event of events)
      if (event.kind === kind) c.fillRect(Math.floor((event.frame / frames) * width), k * line + 1, 2, line - 2);
  });
}
