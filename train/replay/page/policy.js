// @ts-check
/** What a trained network saw and how likely it found each option, computed again from its inputs and weights in the recording. */
import { bytesOf, choosersAt, valueAt } from "./recording.js";
import { plain } from "./look.js";
import { inputWord } from "./words.js";
/** @typedef {import("./recording.js").Run} Run */
/** @typedef {{goals: Record<string, string[]>, observations: string[], mean: number[], deviation: number[], clip: number, activation: string,
 *   widths: number[], weights: string, holds?: Record<string, number>}} Policy holds: decisions for which a choice is kept; weights: of each layer the matrix (inputs, outputs) and the biases, float32 in base64 */

/** Return the layers of a policy, the last one that of the options. @param {Policy} policy @returns {{weights: Float32Array, bias: Float32Array}[]} */
function layersOf({ widths, weights }) {
  const numbers = new Float32Array(bytesOf(weights).buffer);
  let at = 0;
  return widths.slice(1).map((outputs, k) => {
    const layer = { weights: numbers.subarray(at, at + widths[k] * outputs), bias: numbers.subarray(at + widths[k] * outputs, at + (widths[k] + 1) * outputs) };
    at += (widths[k] + 1) * outputs;
    return layer;
  });
}

/** Return the outputs of a policy for its inputs. @param {Policy} policy @param {number[]} inputs */
export function outputsOf(policy, inputs) {
  const layers = layersOf(policy);
  let values = inputs.map((value, k) => Math.max(-policy.clip, Math.min(policy.clip, (value - policy.mean[k]) / policy.deviation[k])));
  layers.forEach(({ weights, bias }, number) => {
    const sums = [...bias].map((own, h) => values.reduce((sum, value, i) => sum + value * weights[i * bias.length + h], own));
    values = number === layers.length - 1 ? sums : sums.map((sum) => (policy.activation === "tanh" ? Math.tanh(sum) : Math.max(0, sum)));
  });
  return values;
}

/** Return probabilities of some outputs. @param {number[]} outputs */
function sharesOf(outputs) {
  const most = Math.max(...outputs), powers = outputs.map((output) => Math.exp(output - most)), sum = powers.reduce((a, b) => a + b, 0);
  return powers.map((power) => power / sum);
}

/** Return the policy that chooses at a frame, if it is in the recording. @param {Run} run @param {number} frame @returns {Policy | undefined} */
export const policyAt = (run, frame) => run.head.policies?.[choosersAt(run, frame).chose];

/**
 * Return the inputs of the policy at a frame, those that moved the choice of a goal's option most first: name, value, and by how much
 * the probability of the option that the robot holds would differ with this input at its mean.
 * @param {Run} run @param {number} frame @param {number} robot @param {string} goal
 */
export function movesOf(run, frame, robot, goal) {
  const policy = policyAt(run, frame), names = run.head.inputs ?? [];
  if (!policy || !policy.goals[goal] || !run.tracks.has("input")) return null;
  const inputs = policy.observations.map((name) => valueAt(run, "input", frame, robot * names.length + names.indexOf(name)));
  let first = 0;
  for (const [other, options] of Object.entries(policy.goals)) { if (other === goal) break; first += options.length; }
  /** Options that the mission does not have are never taken. */
  const known = policy.goals[goal].map((name, k) => [name, first + k]).filter(([name]) => run.head.options[goal]?.includes(String(name)));
  /** @param {number[]} given */
  const shares = (given) => { const outputs = outputsOf(policy, given); return sharesOf(known.map(([, place]) => outputs[Number(place)])); };
  const likely = shares(inputs), option = run.head.options[goal]?.[valueAt(run, `held/${goal}`, frame, robot)];
  const held = known.findIndex(([name]) => name === option), chosen = held < 0 ? likely.indexOf(Math.max(...likely)) : held;
  const moves = policy.observations.map((name, k) => {
    const without = inputs.map((value, j) => (j === k ? policy.mean[k] : value));
    return { name, value: inputs[k], moved: likely[chosen] - shares(without)[chosen] };
  });
  return { option: String(known[chosen][0]), likely: likely[chosen], moves: moves.sort((a, b) => Math.abs(b.moved) - Math.abs(a.moved)) };
}

/** Return the inputs of the policy as HTML: those that moved the choice, then the others. @param {Run} run @param {number} frame @param {number} robot @param {string} goal */
export function inputsOf(run, frame, robot, goal) {
  const found = movesOf(run, frame, robot, goal);
  if (!found) return "";
  const [most] = found.moves, rows = found.moves.map(({ name, value, moved }) =>
    `<tr><td title="${plain(inputWord(name))}">${plain(name)}</td><td class="n">${value.toFixed(2)}</td>
    <td class="n" data-input="${plain(name)}" data-moved="${moved}">${moved > 0 ? "+" : ""}${(100 * moved).toFixed(0)} %</td></tr>`);
  return `<p class="small">${plain(found.option)} has ${(100 * found.likely).toFixed(0)} %. <b title="${plain(inputWord(most.name))}">${plain(most.name)}</b> (${plain(inputWord(most.name).replace(/\.$/, ""))}; here ${most.value.toFixed(2)}) moved the choice most: if it had its
    average, ${plain(found.option)} would have ${(100 * (found.likely - most.moved)).toFixed(0)} %.</p><details class="inputs"><summary class="small" title="What the policy saw, and how much more likely each made the option than its average would.">Inputs of the policy</summary>
    <table>${rows.join("")}</table></details>`;
}
