// @ts-check
/** What can be shown in the worlds, and the legend of all that there is to see. */
import { LOOK, colourOf, keyOf, plain } from "./look.js";
import { everHeld } from "./course.js";
import { GOAL_WORDS, WORDS, optionWord } from "./words.js";
import { element } from "./controls.js";
/** @typedef {import("./recording.js").Run} Run */

const SHOWN_AT_FIRST = ["fields", "paths", "contacts", "numbers", "command", "added", "target", "causes"];

/** Offer the layers that the runs can show, each with its sign, and the goals by whose options robots are coloured. @param {Run[]} runs */
export function offerLayers(runs) {
  /** @type {[string, import("./look.js").Sign][]} */
  const own = [["fields", LOOK.pheromones], ...LOOK.layers];
  const boxes = own.map(([name, sign]) => {
    const known = canShow(name, runs), { word } = sign;
    return `<label title="${plain(WORDS[name] + (known ? "" : " This recording does not hold it."))}"><input type="checkbox" data-layer name="${name}"
      ${known && SHOWN_AT_FIRST.includes(name) ? "checked" : ""} ${known ? "" : "disabled"}>${keyOf(sign)}${word}</label>`;
  });
  boxes.push(`<label title="${WORDS.numbers}"><input type="checkbox" data-layer name="numbers" checked>numbers</label>`,
    runs.some((run) => run.head.walls)
      ? `<label title="${WORDS.walls}"><input type="checkbox" data-layer name="walls" checked>walls</label>`
      : `<label title="Nothing could be drawn: the world is a torus without walls."><input type="checkbox" data-layer name="walls" disabled>walls (this world has none)</label>`);
  element("boxes").innerHTML = boxes.join("");
  const goals = [...new Set(runs.flatMap(({ head }) => Object.keys(head.options)))];
  element("goal").innerHTML = goals.map((goal) => `<option value="${plain(goal)}">${plain(GOAL_WORDS[goal] ?? goal)}</option>`).join("");
  element("colours").hidden = goals.length < 2;
}

/** Show the signs that these runs have, first the options that robots have held until now. @param {Run[]} runs */
export function showLegend(runs) {
  /** @type {Map<string, [string, string]>} */
  const entries = new Map();
  for (const run of runs)
    for (const k of everHeld(run, run.goal)) {
      const word = run.head.options[run.goal][k];
      entries.set(word, [keyOf({ ...LOOK.failed, colour: colourOf(k) }), optionWord(run.head, run.goal, word)]);
    }
  for (const { head } of runs)
    (head.mission.robots.groups ?? []).forEach((/** @type {{model: string}} */ { model }, /** @type {number} */ k) => {
      const shape = LOOK.marks[k % LOOK.marks.length];
      if (shape) entries.set(model, [keyOf({ ...LOOK.failed, colour: LOOK.ink, shape, half: LOOK.item.half }), `Robots of the model ${model} have this mark.`]);
    });
  const drawn = new Set(runs.flatMap((run) => run.head.drawn?.map(({ sign }) => sign) ?? []));
  const signs = Object.entries(LOOK.signs).flatMap(([name, sign]) => (drawn.has(name) ? [sign] : []));
  const areas = runs.some((run) => run.head.things) ? LOOK.areas : [];
  const failed = runs.some(({ tracks }) => tracks.get("working")?.data.some((works, at) => !works && tracks.get("present")?.data[at])) ? [LOOK.failed] : [];
  for (const sign of [...failed, ...signs, ...areas]) entries.set(sign.word, [keyOf(sign), WORDS[sign.word] ?? sign.word]);
  if (runs.some((run) => run.head.zones)) entries.set(LOOK.zone.word, [keyOf(LOOK.zone), WORDS.zones]);
  if (runs.some((run) => run.head.walls)) entries.set(LOOK.wall.word, [keyOf(LOOK.wall), WORDS.walls]);
  element("legend").innerHTML = [...entries].map(([word, [key, told]]) => `<span title="${plain(told)}">${key}${plain(word)}</span>`).join(" ");
}

/** Return whether recordings hold what a layer shows. @param {string} name @param {Run[]} runs */
function canShow(name, runs) {
  const needed = { command: "command_x", added: "wish_x", causes: "cause" }[name];
  return !needed || runs.some((run) => run.tracks.has(needed));
}
