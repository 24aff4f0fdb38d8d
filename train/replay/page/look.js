// @ts-check
/** How things look: colours, signs, and texts for HTML. */
/** @typedef {Record<string, boolean>} Layers by their names: whether each is shown */
/** @typedef {{ink: string, paper: string, faint: string, rim: string}} Colours; rim: around robots */

/** @typedef {{word: string, colour: string, shape: string, half: number, letter: string, opacity: number}} Sign */
/**
 * How things look, as `clean_swarm_env/drawing/look.py` defines it; signs: those that tasks may draw, by name.
 * @type {{options: string[], ink: string, paper: string, edge: string, contact: string,
 *   least_area: number, front_angle: number, front_length: number, cargo_behind: number, cargo_half: number, marks: string[], mark_half: number, letter_size: number,
 *   most_numbered: number, least_numbered: number, failed: Sign, item: Sign, pheromones: Sign,
 *   zone: Sign, wall: Sign, wall_width: number, layers: [string, Sign][], areas: Sign[], signs: Record<string, Sign>}}
 */
export const LOOK = JSON.parse(document.getElementById("look")?.textContent ?? "");

/** Return the colour of a number: of an option, a term, or a kind of events. @param {number} k */
export const colourOf = (k) => LOOK.options[k % LOOK.options.length];

/** Return red, green and blue of a colour. @param {string} colour */
export const partsOf = (colour) => [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));

/** Return a colour with an opacity. @param {string} colour @param {number} opacity */
export const faded = (colour, opacity) => `rgb(${partsOf(colour).join(" ")} / ${opacity})`;
/** Escape a text for HTML. @param {unknown} text */
export const plain = (text) => String(text).replace(/[&<>"]/g, (sign) => `&#${sign.charCodeAt(0)};`);

/** Return the sign of a legend as HTML. @param {Sign} sign */
export const keyOf = ({ colour, shape, half, letter, opacity }) => {
  const own = colour === LOOK.ink ? "var(--ink)" : faded(colour, opacity); // ink is bright on a dark page
  return `<i class="key ${shape}" style="background:${own};--own:${own};--size:${(0.8 * half) / LOOK.item.half}">${letter}</i>`;
};
