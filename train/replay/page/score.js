// @ts-check
/** What a run has brought and cost up to a frame; `clean_swarm_env/tasks/cleaning/cost.py` defines the cost. */
import { valueAt } from "./recording.js";
import { plain } from "./look.js";
/** @typedef {import("./recording.js").Run} Run */
/** @typedef {import("./course.js").Counts} Counts */
/** @typedef {{time: number, priced: number, contacts: number, left: number, items: number, all: number, cost: number}} Cost parts [s]; priced: collisions one by one, contacts: what they cost together; items: dumped */

const NO_ITEM = 0.3;

/**
 * Return what a run has cost up to a frame if it ended there: its parts, and all together, for each item where garbage
 * keeps coming; null in a recording that does not say what things cost.
 * @param {Run} run @param {Counts} counts @param {number} frame @param {number} time [s] @returns {Cost | null}
 */
export function costOf(run, counts, frame, time) {
  const prices = run.head.prices, items = counts.items[frame] ?? 0;
  if (!prices) return null;
  const priced = prices.event * (counts.contacts[frame] ?? 0) + prices.sample * (frame < 0 ? 0 : valueAt(run, "samples", frame));
  const contacts = priced <= prices.limit ? priced : prices.limit * (2 - prices.limit / priced);
  const left = prices.left * Math.max(prices.items - items, 0);
  const cost = prices.left ? time + contacts + left : (time + contacts) / Math.max(items, NO_ITEM);
  return { time, priced, contacts, left, items, all: prices.items, cost };
}

/** @param {number} seconds */
const whole = (seconds) => `${Math.round(seconds).toLocaleString("en")} s`;

/** Return of what a cost consists, so that its parts add up to it. @param {Run} run @param {Cost} cost @param {number} collisions */
function partsOfCost(run, { time, priced, contacts, left, items }, collisions) {
  const { limit = 0, left: price } = run.head.prices ?? {}, rest = Math.round(time + contacts) - Math.round(time);
  const less = priced > limit ? ` (${whole(priced)} one by one: beyond ${whole(limit)} each costs less)` : "";
  const split = `${whole(time)} + ${whole(rest)} for ${collisions} collision${collisions === 1 ? "" : "s"}${less}`;
  if (!price) return `(${split}) / ${Math.max(items, NO_ITEM)} items`;
  return left ? `${split}; items left: ${whole(left)} more` : split;
}

/** Return the running score as HTML. @param {Run} run @param {Counts} counts @param {number} frame @param {number} time [s] */
export function scoreOf(run, counts, frame, time) {
  const collisions = counts.contacts[frame] ?? 0, cost = costOf(run, counts, frame, time);
  const near = run.head.counted_distances?.[0];
  const events = `<span title="Pairs of robots that came ${near ? `closer than ${Number(near.toFixed(3))} m` : "too close"}."><b data-collisions>${collisions}</b> collision${collisions === 1 ? "" : "s"}</span>`;
  if (!run.tracks.has("dumped")) return events;
  const of = cost?.all ? ` of ${cost.all}` : "", items = counts.items[frame] ?? 0;
  const dumped = `<span title="Items that have been recycled and dumped: the work that is done."><b data-items>${items}</b>${of} item${cost?.all || items !== 1 ? "s" : ""} dumped</span>`;
  if (!cost) return `${dumped}${events}`;
  const split = partsOfCost(run, cost, collisions), { event, sample } = run.head.prices ?? { event: 0, sample: 0 };
  const contact = sample ? `, and ${Number((sample * run.head.mission.world.physics_rate).toPrecision(2))} s a second in contact` : "";
  const told = `What the run costs up to now: its seconds, ${event} s a collision${contact}, and two time limits for each item that is left if it ended now${cost.all ? "" : "; for each item, because garbage keeps coming"}.`;
  return `${dumped}${events}<span title="${plain(told)}">cost so far <b data-cost="${cost.cost}">${whole(run.head.prices?.left ? cost.time + cost.contacts : cost.cost)}</b> <span class="split small">= ${split}</span></span>`;
}

/** Return the verdict on a run that is over, in a line, and its cost [s]. @param {Run} run @returns {{words: string, cost: number, done: boolean}} */
export function verdictOf(run) {
  const { result, head } = run, done = Boolean(result?.completed), coming = head.prices && !head.prices.left;
  const cost = Number(result?.cost_s ?? NaN), time = `${Number((result?.duration_s ?? 0).toFixed(1))} s`;
  if (head.things) {
    const measures = Object.entries(result?.measures ?? {}).map(([name, value]) => `${name} ${Number(value.toPrecision(3))}`);
    return { words: `${done ? "Completed" : "Time is over"} after ${time}: ${measures.join(", ")}.`, cost, done };
  }
  const items = `${result?.garbage_done ?? 0}${head.prices?.items ? ` of ${head.prices.items}` : ""} items`;
  const words = done ? `Clean: ${items} in ${time}.` : coming ? `Time is over: ${items} in ${time}.` : `Not clean: ${items} when the time was over.`;
  return { words, cost, done };
}
