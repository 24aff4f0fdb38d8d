// @ts-check
/** What goes on in one robot, as a panel. */
import { changesUntil, choosersAt, loadOf, titleOf, valueAt } from "./recording.js";
import { shorter } from "./course.js";
import { LOOK, colourOf, plain } from "./look.js";
import { TERM_WORDS, optionWord, robotWord } from "./words.js";
import { factsOf, sentenceOf } from "./why.js";
import { inputsOf, policyAt } from "./policy.js";
/** @typedef {import("./recording.js").Run} Run */

const NONE = "0.00"; // a share that leaves an option out of the table, unless it is held
const STILL = 0.1; // [m] within which a robot stands still

/** @param {string} sign of what is carried */
const carriedWord = (sign) => `${sign === "item" ? "an " : ""}${LOOK.signs[sign].word}`;

/** @param {number} value @param {number} digits */
const fixed = (value, digits = 2) => value.toFixed(digits);

/**
 * Return why a behaviour runs or does not, in words.
 * @param {Run} run @param {string} prefix of the network @param {number} frame @param {number} robot @param {number} b
 */
export function whyOf(run, prefix, frame, robot, b) {
  const names = /** @type {import("./recording.js").NetworkNames} */ (run.head.networks?.[prefix]);
  const at = robot * names.behaviours.length + b;
  const by = valueAt(run, `${prefix}/by`, frame, at);
  return (run.head.reasons?.[valueAt(run, `${prefix}/reason`, frame, at)] ?? "").replace("{by}", by >= 0 ? names.behaviours[by] : "");
}

/**
 * Return what a behaviour that is not ready needs, with what the sensors read.
 * @param {Run} run @param {string} prefix @param {number} frame @param {number} robot @param {number} b
 */
function needsOf(run, prefix, frame, robot, b) {
  const names = /** @type {import("./recording.js").NetworkNames} */ (run.head.networks?.[prefix]);
  const name = names.behaviours[b], held = run.head.options[name] ? valueAt(run, `held/${name}`, frame, robot) : -1;
  const all = names.needs[b].filter(([tag]) => tag === -1 || tag === held).map(([, sensor, wanted]) => {
    const reads = valueAt(run, `${prefix}/readings`, frame, robot * names.sensors.length + names.sensors.indexOf(sensor));
    const fact = wanted.startsWith("Boolean") ? Number(wanted.includes("True")) : -1;
    const text = fact < 0 ? `${sensor} ${wanted}, reads ${fixed(reads)}` : `${sensor} ${fact ? "true" : "false"}`;
    return { text, missing: fact >= 0 && reads !== fact, fact };
  });
  const missing = all.filter((need) => need.missing), told = missing.length ? missing : all.filter((need) => need.fact < 0);
  return told.length ? `needs ${told.map((need) => need.text).join("; ")}` : "";
}

/**
 * Return for how long a behaviour of the robot's network has been running [s], the step included.
 * @param {Run} run @param {number} frame @param {number} robot @param {number} b
 */
function ranFor(run, frame, robot, b) {
  const at = robot * (run.head.networks?.robot.behaviours.length ?? 0) + b;
  let since = frame;
  while (since >= 0 && valueAt(run, "robot/running", since, at)) since--;
  return (frame - since) * run.head.period;
}

/** Return a bar of signed parts around a middle, as HTML. @param {number[]} parts @param {number} most */
function stacked(parts, most) {
  let up = 0, down = 0, bars = "";
  parts.forEach((part, k) => {
    const width = (Math.abs(part) / most) * 50;
    if (width < 0.05) return;
    if (part < 0) down += width;
    bars += `<i style="left:${part > 0 ? 50 + up : 50 - down}%;width:${width}%;background:${colourOf(k)}"></i>`;
    if (part > 0) up += width;
  });
  return `<div class="bar">${bars}<em></em></div>`;
}

/** @param {string} colour @param {string} text @param {string} told */
const key = (colour, text, told) => `<span title="${plain(told)}"><span class="key" style="background:${colour}"></span>${plain(text)}</span>`;

/** Return how fast a robot moves, or for how long it has stayed where it is, in words. @param {Run} run @param {number} frame @param {number} robot */
export function movementOf(run, frame, robot) {
  const { width, height, period } = run.head, x = valueAt(run, "x", frame, robot), y = valueAt(run, "y", frame, robot);
  /** @param {number} at */
  const away = (at) => Math.hypot(shorter(valueAt(run, "x", at, robot) - x, width), shorter(valueAt(run, "y", at, robot) - y, height));
  let since = frame;
  while (since > 0 && valueAt(run, "present", since - 1, robot) && away(since - 1) < STILL) since--;
  const still = (frame - since) * period;
  if (!frame || !valueAt(run, "present", frame - 1, robot)) return "It begins here.";
  if (still >= 1) return `It has stayed within ${STILL} m for ${fixed(still, 1)} s.`;
  return `It moves at ${fixed(away(frame - 1) / period)} m/s.`;
}

/** Return the panel of a robot at a frame as HTML. @param {Run} run @param {number} frame @param {number} robot @param {string} beside below its sentence */
export function panelOf(run, frame, robot, beside = "") {
  const { head } = run, parts = [];
  const works = valueAt(run, "working", frame, robot), there = valueAt(run, "present", frame, robot);
  const load = loadOf(run, frame, robot), carries = head.drawn?.some(({ at }) => at === "robot");
  parts.push(`<div class="turn"><h2>Robot ${robot}</h2> <button data-turn="-1" title="The robot before (down).">before</button> <button data-turn="1" title="The next robot (up).">next</button></div><p>${plain(titleOf(run, frame))}</p>`);
  const over = run.result && frame >= run.frames - 1 ? "the run is over; in its last step it " : "";
  if (run.tracks.has("command_x")) parts.push(`<p class="because" data-sentence>${over}${plain(sentenceOf(factsOf(run, frame, robot), head.task_words))}</p>`);
  parts.push(beside);
  if (!works) parts.push(`<p><b>${there ? "It has failed: its body stands." : "It is not there."}</b></p>`);
  parts.push(`<p>It is at <span data-channel="x">${fixed(valueAt(run, "x", frame, robot), 3)}</span> m,
    <span data-channel="y">${fixed(valueAt(run, "y", frame, robot), 3)}</span> m${carries ? ` and carries ${load ? carriedWord(load) : "nothing"}` : ""}.</p>`);
  if (works) parts.push(`<p data-movement>${movementOf(run, frame, robot)}</p>`);
  for (const [goal, options] of Object.entries(head.options)) parts.push(optionsOf(run, goal, options, frame, robot));
  if (head.networks) {
    parts.push(networkOf(run, "robot", frame, robot), insideOf(run, frame, robot), planOf(run, frame, robot));
    parts.push(readingsOf(run, frame, robot), goalsOf(run, frame, robot));
  } else parts.push("<p>The networks of the robots were not recorded (<code>--minds</code>).</p>");
  if (run.tracks.has("missed")) parts.push(`<p>Poses of others missed: ${valueAt(run, "missed", frame, robot)}</p>`);
  return parts.join("");
}

/** Return what the chooser thought of each option of a goal when it last decided. @param {Run} run @param {string} goal @param {number} frame @param {number} robot */
const opinionsOf = (run, goal, frame, robot) => run.head.options[goal].map((_, k, { length }) => valueAt(run, `opinion/${goal}`, frame, robot * length + k));

/** Return whether opinions are probabilities. @param {number[]} values */
const areShares = (values) => Math.min(...values) >= 0 && Math.abs(values.reduce((a, b) => a + b, 0) - 1) < 0.02;

/**
 * Return why a robot holds an option of which its chooser does not think most, in words; nothing where it thinks most of it.
 * @param {Run} run @param {string} goal @param {number} frame @param {number} robot
 */
export function whyHeld(run, goal, frame, robot) {
  const { ticks_per_decision: step, period } = run.head, name = `held/${goal}`, held = valueAt(run, name, frame, robot);
  /** @param {number} at */
  const isHighest = (at) => { const values = opinionsOf(run, goal, at, robot); return values[held] >= Math.max(...values); };
  if (isHighest(frame)) return "";
  const change = changesUntil(run, frame).findLast((one) => one.do === "follow_strategy" || (one.do === "hold_option" && (!one.robots?.length || one.robots.includes(robot))));
  if (change?.option) return "It is held by hand.";
  let at = frame - (frame % step);
  while (at >= 0 && valueAt(run, name, at, robot) === held && !isHighest(at)) at -= step;
  const kept = policyAt(run, frame)?.holds?.[goal] ?? 1;
  if (at >= 0 && valueAt(run, name, at, robot) === held)
    return `It still was at ${fixed(at * period, 1)} s${kept > 1 ? `; a choice is kept for ${fixed(kept * step * period, 0)} s` : ", and has been held since"}.`;
  if (!areShares(opinionsOf(run, goal, frame, robot))) return "It is tried although others are thought more of: the strategy still learns.";
  return `It was drawn${Object.keys(run.head.options).length > 1 ? ", or chosen because it goes best with the option of another goal" : " by these probabilities"}.`;
}

/** @param {Run} run @param {string} goal @param {string[]} options @param {number} frame @param {number} robot */
function optionsOf(run, goal, options, frame, robot) {
  const held = valueAt(run, `held/${goal}`, frame, robot), { chose, next } = choosersAt(run, frame);
  const head = `<h3 title="${plain(robotWord("Goal", goal))}">${plain(goal)}: <span data-held="${plain(goal)}">${plain(options[held])}</span></h3>`;
  if (chose !== next) return `${head}<p class="small" data-waits>${plain(next)} has not decided yet: it does at its next decision. Until then robots hold what ${plain(chose)} chose.</p>`;
  const values = opinionsOf(run, goal, frame, robot), thought = run.tracks.has(`opinion/${goal}`), shares = areShares(values);
  const most = values.every((value) => value >= 0 && value <= 1) ? 1 : Math.max(...values.map(Math.abs)); // of shares the whole is 1
  const rows = options.map((name, k) => thought && shares && k !== held && fixed(values[k]) === NONE ? "" : `<tr class="${k === held ? "run" : ""}"><td>${key(goal === run.goal ? colourOf(k) : LOOK.edge, name, optionWord(run.head, goal, name))}</td>
    <td><div class="bar"><i style="left:0;width:${thought ? (Math.abs(values[k]) / most) * 100 : 0}%;background:${goal === run.goal ? colourOf(k) : LOOK.edge}"></i></div></td>
    <td class="n">${thought ? fixed(values[k]) : ""}</td></tr>`);
  const rare = options.filter((_, k) => !rows[k]), others = rare.length ? `<details class="others"><summary class="small">${rare.length} other ${rare.length > 1 ? "options" : "option"}, ${NONE}</summary>
    <p class="small">${rare.map((name) => key(goal === run.goal ? colourOf(options.indexOf(name)) : LOOK.edge, name, optionWord(run.head, goal, name))).join(" ")}</p></details>` : "";
  const told = shares ? "Of pairs and longer combinations: of all that have this option." : "A score, or an estimate of what it brings.";
  const title = shares && values.includes(1) ? "The chooser takes, without chance:" : shares ? "How likely the chooser finds each option, 1.00 in sum:" : "What the chooser thinks of each option:", why = thought ? whyHeld(run, goal, frame, robot) : "";
  return `${head}${thought ? `<p class="small" title="${told}">${title}</p>` : ""}<table>${rows.join("")}</table>${others}
    ${why ? `<p class="small" data-why="${plain(goal)}"><b>${plain(options[held])}</b> is not the highest. ${plain(why)}</p>` : ""}${inputsOf(run, frame, robot, goal)}`;
}

/** @param {Run} run @param {string} prefix @param {number} frame @param {number} robot */
function networkOf(run, prefix, frame, robot) {
  const names = /** @type {import("./recording.js").NetworkNames} */ (run.head.networks?.[prefix]);
  const terms = run.head.terms ?? [], count = names.behaviours.length;
  /** @param {number} b @param {number} term */
  const value = (b, term) => valueAt(run, `${prefix}/values`, frame, (robot * terms.length + term) * count + b);
  const order = [...names.behaviours.keys()].filter((b) => valueAt(run, `${prefix}/present`, frame, robot * count + b));
  order.sort((a, b) => value(b, 0) - value(a, 0));
  const most = Math.max(0.5, ...order.map((b) => terms.slice(2).reduce((sum, _, k) => sum + Math.abs(value(b, k + 2)), 0)));
  const rows = order.map((b) => {
    const running = valueAt(run, `${prefix}/running`, frame, robot * count + b), ready = valueAt(run, `${prefix}/ready`, frame, robot * count + b);
    return `<tr class="${running ? "run" : ""}" data-network="${plain(prefix)}" data-behaviour="${plain(names.behaviours[b])}"
      data-activation="${value(b, 0)}" data-parts="${terms.slice(2).map((_, k) => value(b, k + 2)).join(" ")}" data-running="${running}">
      <td title="${plain(robotWord("Behaviour", names.behaviours[b]))}">${running ? "&#9654; " : ""}${plain(names.behaviours[b])}
      ${running ? `<span class="small" data-ran>for ${fixed(ranFor(run, frame, robot, b), 1)} s</span>` : ""}<div class="why">${plain(whyOf(run, prefix, frame, robot, b))}</div>
      ${ready ? "" : `<div class="why">${plain(needsOf(run, prefix, frame, robot, b))}</div>`}</td>
      <td>${stacked(terms.slice(2).map((_, k) => value(b, k + 2)), most)}</td><td class="n">${fixed(value(b, 0))}</td></tr>`;
  });
  const threshold = valueAt(run, `${prefix}/thresholds`, frame, robot * 3 + 2);
  return `<h3 title="What the robot can do; behaviours that are ready and active enough run.">Behaviours, the most active first</h3><p class="small">The step was decided by the threshold ${fixed(threshold)}.
    Bars: what the step added to each activation.</p><table>${rows.join("")}</table>
    <div class="small">${terms.slice(2).map((term, k) => key(colourOf(k), term.replace("_", " "), TERM_WORDS[term] ?? term)).join(" ")}</div>`;
}

/** Return the networks inside behaviours that run. @param {Run} run @param {number} frame @param {number} robot */
function insideOf(run, frame, robot) {
  /** @type {string[]} */
  const lines = [];
  for (const prefix of Object.keys(run.head.networks ?? {})) {
    const [goal, option] = [prefix.split("/")[0], prefix.split("/").slice(1).join("/")];
    if (prefix === "robot" || (run.head.options[goal] && run.head.options[goal][valueAt(run, `held/${goal}`, frame, robot)] !== option)) continue;
    const names = /** @type {import("./recording.js").NetworkNames} */ (run.head.networks?.[prefix]), outer = run.head.networks?.robot.behaviours ?? [];
    if (!valueAt(run, "robot/running", frame, robot * outer.length + outer.indexOf(goal))) continue;
    names.behaviours.forEach((name, b) => lines.push(`<li>${plain(name)}: ${plain(whyOf(run, prefix, frame, robot, b))} <span class="small">in ${plain(prefix)}</span></li>`));
  }
  return lines.length ? `<h3 title="What runs inside the option.">Inside</h3><ul>${lines.join("")}</ul>` : "";
}

/** @param {Run} run @param {number} frame @param {number} robot */
function planOf(run, frame, robot) {
  const track = run.tracks.get("robot/plan");
  if (!track) return "";
  const most = track.columns / run.head.robots;
  const names = run.head.networks?.robot.behaviours ?? [];
  const length = valueAt(run, "robot/plan_length", frame, robot), due = valueAt(run, "robot/plan_due", frame, robot);
  const steps = Array.from({ length: Math.min(Math.max(length, 0), most) }, (_, k) =>
    `<span data-step class="${k === due ? "due" : k < due ? "past" : ""}">${plain(names[valueAt(run, "robot/plan", frame, robot * most + k)])}</span>`);
  return `<h3 title="Steps that lead from what the robot senses to its goals; the coloured one is due.">Plan</h3><div class="plan" data-plan="${length}">${length < 0 ? "no plan" : steps.join(" &rarr; ") || "nothing to do"}</div>`;
}

/** @param {Run} run @param {number} frame @param {number} robot */
function readingsOf(run, frame, robot) {
  const names = run.head.networks?.robot.sensors ?? [];
  const cells = names.map((name, k) => {
    const value = valueAt(run, "robot/readings", frame, robot * names.length + k);
    return `<td title="${plain(robotWord("Sensor", name))}">${plain(name)}</td><td class="n" data-sensor="${plain(name)}" data-value="${value}">${fixed(value)}</td>`;
  });
  const rows = cells.map((cell, k) => (k % 2 ? "" : `<tr>${cell}${cells[k + 1] ?? ""}</tr>`));
  return `<h3 title="What the robot senses now.">Sensors</h3><table>${rows.join("")}</table>`;
}

/** @param {Run} run @param {number} frame @param {number} robot */
function goalsOf(run, frame, robot) {
  const names = run.head.networks?.robot.goals ?? [];
  const rows = names.map((name, k) => {
    const value = valueAt(run, "robot/goals", frame, robot * names.length + k);
    return `<tr><td title="${plain(robotWord("Goal", name))}">${plain(name)}</td><td><div class="bar"><i style="left:0;width:${value * 100}%;background:${LOOK.areas[0].colour}"></i></div></td>
      <td class="n" data-goal="${plain(name)}" data-value="${value}">${fixed(value)}</td></tr>`;
  });
  return names.length ? `<h3 title="1: the goal is reached; what would help the others gets more activation.">Goals: how far each is satisfied</h3><table>${rows.join("")}</table>` : "";
}
