// @ts-check
/** What is foretold of one robot under each option: a table, and the ways in the world. */
import { shorter } from "./course.js";
import { colourOf, plain } from "./look.js";
/** @typedef {{option: string, seconds: number, collisions: number, own_collisions: number, items: number, cost_s: number, measures?: Record<string, number>, path: [number, number][]}} Foretold */
/** @typedef {{robot: number, time: number, options: Foretold[]}} Answer of the server; time: from when on [s] */

/** Return the table of what is foretold as HTML. @param {Answer} answer */
export function foretoldOf({ robot, time, options }) {
  const costs = options.map((one) => one.cost_s), least = Math.min(...costs), most = Math.max(...costs);
  const measured = Object.keys(options[0]?.measures ?? {}), figures = measured.length ? measured : ["items"];
  const rows = options.map((one, k) => `<tr class="${one.cost_s === least && least < most ? "run" : ""}" data-foretold="${plain(one.option)}">
    <td><span class="key" style="background:${colourOf(k)}"></span>${plain(one.option)}</td><td class="n">${one.own_collisions}</td><td class="n">${one.collisions}</td>
    ${figures.map((name) => `<td class="n">${Number((one.measures?.[name] ?? one.items).toPrecision(3))}</td>`).join("")}<td class="n">${one.cost_s.toFixed(1)} s</td></tr>`);
  return `<h3 title="A copy of the world ran on for each option; nothing else was done by hand in it.">What if robot ${robot} took another option at ${time.toFixed(1)} s: the next ${options[0]?.seconds ?? 0} s</h3>
    <table class="foretold"><tr class="small"><td>option</td><td class="n" title="Collisions of this robot.">own</td><td class="n" title="Collisions of all robots.">all</td>
    ${figures.map((name) => `<td class="n" title="${measured.length ? "The measure of the mission if it ended then." : "Items dumped by all robots."}">${plain(name)}</td>`).join("")}<td class="n" title="${measured.length ? "By how much the mission costs more if it ends then." : "Seconds and the price of the collisions of all robots."}">cost</td></tr>${rows.join("")}</table>`;
}

/** Draw the ways that are foretold. @param {import("./world.js").WorldView} view @param {Answer} answer */
export function drawForetold(view, { options }) {
  const { width, height } = view.run.head, c = /** @type {CanvasRenderingContext2D} */ (view.canvas.getContext("2d"));
  options.forEach(({ path }, k) => {
    let [px, py] = view.place(...path[0]);
    c.strokeStyle = c.fillStyle = colourOf(k);
    c.lineWidth = 3;
    c.beginPath();
    c.moveTo(px, py);
    path.slice(1).forEach(([x, y], at) => { // step by step, for the seam of the torus
      px += shorter(x - path[at][0], width) * view.scale;
      py -= shorter(y - path[at][1], height) * view.scale;
      c.lineTo(px, py);
    });
    c.stroke();
    c.beginPath();
    c.arc(px, py, 4, 0, 7);
    c.fill();
  });
}
