// @ts-check
/**
 * Reading of recordings in the page; docs/recordings.md describes the bytes.
 *
 * @typedef {{name: string, axes: string[], shape: number[], scale: number, order: number, unit: string, about: string}} Channel
 * @typedef {{channel: string, attraction: number, diffusion: number, goal_radius: number, evaporation_factor: number,
 *   evaporation_period: number, min_diffusion: number}} DepositKind
 * @typedef {{behaviours: string[], sensors: string[], goals: string[], needs: [number, string, string][][]}} NetworkNames
 * @typedef {{about: Record<string, any>, period: number, width: number, height: number, robots: number, items: number,
 *   minds: boolean, options: Record<string, string[]>, views: Record<string, number[]>, mission: any,
 *   ticks_per_decision: number, counted_distances?: number[], channels: Channel[], terms?: string[], reasons?: string[],
 *   networks?: Record<string, NetworkNames>, models?: number[], walls?: [number, number, number, number][], zones?: [string, number, number, number, number][], shown?: [number, number], field?: number,
 *   things?: Thing[], option_words?: Record<string, string[]>, inputs?: string[],
 *   policies?: Record<string, import("./policy.js").Policy>, drawn?: Drawn[], events?: {of: string, event: string, about: string}[], destinations?: Destination[], task_words?: TaskWords,
 *   prices?: {event: number, sample: number, limit: number, left: number, items: number}}} Head; models: number of each robot's model, if they differ; of tasks other than cleaning: field, the longer
 *   side of the ground, or of the rectangle of open land in which robots start [m], and the things
 * @typedef {{channel: string, attraction: number, x: number, y: number, radius: number, moves?: number}} Thing at the start; moves: its
 *   number in the channels of things that move
 * @typedef {{at: string, where: Record<string, [number, number]>, numbers: number[] | null}} Chosen some of the things or robots: where: name of a channel and its
 *   least and largest value; numbers: null for all
 * @typedef {Chosen & {sign: string, radius: number}} Drawn
 * @typedef {Chosen & {word: string, when: Record<string, boolean>, certain: boolean}} Destination when: sensor, and whether it reads more than 0
 * @typedef {{doing: Record<string, string>, searching: Record<string, string>, sees: string}} TaskWords
 * @typedef {{tick: number, do: string, robot?: number, robots?: number[], strategy?: string, option?: string}} Change what was done by hand before a frame was decided
 * @typedef {{first: number, frames: number, sizes: [number, number][], deposits?: DepositKind[], by_hand?: Change[], made?: number}} Directory
 * @typedef {{channel: Channel, columns: number, data: Int32Array, room: Int32Array}} Track frame-major: number k of frame t is at
 *   t * columns + k of data, which is the beginning of room
 * @typedef {{head: Head, frames: number, tracks: Map<string, Track>, deposits: DepositKind[], byHand: Change[], made: number,
 *   result: Record<string, any> | null, ahead: number, coming: Change[], goal: string}} Run goal: whose options give robots their colours; made: time at which the last frame of a session was made
 *   [s since 1970]; ahead: 1 if the present of a session is in `room` behind its last frame, with what was done by hand since then
 */

const MAGIC = "\x93SWARM\r\n";

/** Return the bytes of a base64 text. @param {string} text @returns {Uint8Array} */
export function bytesOf(text) {
  const binary = atob(text.trim());
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; i++) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

/** Return the content of a zlib stream. @param {Uint8Array} bytes @returns {Promise<Uint8Array>} */
async function inflate(bytes) {
  const stream = new Blob([/** @type {BlobPart} */ (bytes)]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Return the bytes with which a recording begins, MAGIC and version, checked. @param {Uint8Array} bytes */
function checkBeginning(bytes) {
  const version = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength).getUint32(8, true);
  if (String.fromCharCode(...bytes.subarray(0, 8)) !== MAGIC) throw new Error("expected a recording, got other data");
  if (version !== 1) throw new Error(`expected a recording of version 1, got ${version}`);
}

/** Return kind and content of the whole blocks in bytes. @param {Uint8Array} bytes @returns {Promise<[string, Uint8Array][]>} */
export function blocksIn(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  /** @type {Promise<[string, Uint8Array]>[]} */
  const waiting = [];
  for (let at = 0; at + 12 <= bytes.length; ) {
    const kind = String.fromCharCode(...bytes.subarray(at, at + 4));
    const length = view.getUint32(at + 4, true);
    if (at + 12 + length > bytes.length) break;
    const content = bytes.subarray(at + 12, at + 12 + length);
    waiting.push(inflate(content).then((inflated) => [kind, inflated]));
    at += 12 + length;
  }
  return Promise.all(waiting);
}

/** Return the recording that a file holds, or the beginning of one. @param {Uint8Array} bytes @returns {Promise<Run>} */
export async function readRecording(bytes) {
  checkBeginning(bytes);
  const [[, head], ...blocks] = await blocksIn(bytes.subarray(12));
  const run = newRun(JSON.parse(new TextDecoder().decode(head)));
  const parts = blocks.filter(([kind]) => kind === "DATA");
  reserve(run, parts.reduce((sum, [, content]) => sum + directoryOf(content).directory.frames, 0));
  for (const [kind, content] of blocks) addBlock(run, kind, content);
  return run;
}

/** Return a run without frames. @param {Head} head @returns {Run} */
function newRun(head) {
  const tracks = new Map(head.channels.map((channel) => {
    const columns = channel.shape.reduce((a, b) => a * b, 1), data = new Int32Array(0);
    return [channel.name, { channel, columns, data, room: data }];
  }));
  return { head, frames: 0, tracks, deposits: [], byHand: [], made: 0, result: null, ahead: 0, coming: [], goal: Object.keys(head.options)[0] ?? "" };
}

/** Make room for `frames` frames. @param {Run} run @param {number} frames */
function reserve(run, frames) {
  for (const track of run.tracks.values()) {
    if (track.room.length >= frames * track.columns) continue;
    track.room = new Int32Array(frames * track.columns);
    track.room.set(track.data);
  }
}

/** Return the directory of a part, and where its channels begin. @param {Uint8Array} content @returns {{directory: Directory, at: number}} */
function directoryOf(content) {
  const length = new DataView(content.buffer, content.byteOffset).getUint32(0, true);
  return { directory: JSON.parse(new TextDecoder().decode(content.subarray(4, 4 + length))), at: 4 + length };
}

/** Append a block to a run. @param {Run} run @param {string} kind @param {Uint8Array} content */
export function addBlock(run, kind, content) {
  if (kind === "DONE") run.result = JSON.parse(new TextDecoder().decode(content));
  if (kind !== "DATA") return;
  const { directory } = unpackBehind(run, content), frames = run.frames + directory.frames;
  for (const track of run.tracks.values()) track.data = track.room.subarray(0, frames * track.columns);
  run.frames = frames;
  run.deposits = directory.deposits ?? [];
  run.byHand.push(...(directory.by_hand ?? []));
  run.made = directory.made ?? 0;
  [run.ahead, run.coming] = [0, []];
}

/** Show the present of a session behind its last frame, until the next one comes; false if frames before it have not come. @param {Run} run @param {Uint8Array} content of a block */
export function showPresent(run, content) {
  const { directory } = directoryOf(content);
  if (directory.first === run.frames) {
    unpackBehind(run, content);
    run.deposits = directory.deposits ?? [];
    [run.ahead, run.coming] = [1, directory.by_hand ?? []];
  }
  return directory.first <= run.frames;
}

/** Unpack a part behind the last frame of a run, where there is room for it. @param {Run} run @param {Uint8Array} content */
function unpackBehind(run, content) {
  const part = { ...directoryOf(content), content }, frames = run.frames + part.directory.frames;
  const fits = [...run.tracks.values()].every(({ room, columns }) => room.length >= frames * columns);
  if (!fits) reserve(run, Math.max(frames, 2 * run.frames, 64));
  run.head.channels.forEach((channel, c) => {
    const track = /** @type {Track} */ (run.tracks.get(channel.name));
    part.at = unpack(part, c, channel.order, track.columns, track.room);
  });
  return part;
}

/**
 * Unpack one channel of one part into `data`; return where the next channel begins.
 * @param {{directory: Directory, content: Uint8Array, at: number}} part @param {number} c @param {number} order
 * @param {number} columns @param {Int32Array} data
 */
function unpack(part, c, order, columns, data) {
  const { directory, content } = part;
  const [changing, width] = directory.sizes[c];
  const { first, frames } = directory;
  const begin = new DataView(content.buffer, content.byteOffset + part.at, 4 * columns);
  const bitsAt = part.at + 4 * columns;
  const stepsAt = bitsAt + Math.ceil(columns / 8);
  const count = changing * (frames - 1);
  let place = 0;
  for (let k = 0; k < columns; k++) {
    let value = begin.getInt32(4 * k, true);
    let speed = 0;
    let at = first * columns + k;
    data[at] = value;
    const moves = (content[bitsAt + (k >> 3)] >> (k & 7)) & 1;
    for (let t = 1; t < frames; t++) {
      if (moves) {
        const p = stepsAt + place++;
        let step = width === 1 ? (content[p] << 24) >> 24 : content[p];
        if (width === 2) step |= (content[p + count] << 24) >> 16;
        if (width === 4) step |= (content[p + count] << 8) | (content[p + 2 * count] << 16) | (content[p + 3 * count] << 24);
        speed = order === 2 ? speed + step : step;
        value = (value + speed) | 0;
      }
      at += columns;
      data[at] = value;
    }
  }
  return stepsAt + count * width;
}

/** Return the CRC-32 of bytes, as zlib has it. @param {Uint8Array} bytes @returns {number} */
export function crc32(bytes) {
  const table = new Int32Array(256).map((_, n) => {
    for (let k = 0; k < 8; k++) n = n & 1 ? (n >>> 1) ^ 0xedb88320 : n >>> 1;
    return n;
  });
  let crc = -1;
  for (let i = 0; i < bytes.length; i++) crc = (crc >>> 8) ^ table[(crc ^ bytes[i]) & 255];
  return (crc ^ -1) >>> 0;
}

/** Return the checksum of each channel, as `checksums` has it in Python. @param {Run} run @returns {Record<string, number>} */
export function checksums(run) {
  /** @type {Record<string, number>} */
  const found = {};
  for (const [name, track] of run.tracks) found[name] = crc32(new Uint8Array(track.data.buffer, 0, track.data.byteLength));
  return found;
}

/** Return number k of a channel at a frame, in its unit; 0 where there is no such channel. @param {Run} run @param {string} name @param {number} frame @param {number} k */
export function valueAt(run, name, frame, k = 0) {
  const track = run.tracks.get(name);
  return track ? track.room[frame * track.columns + k] / track.channel.scale : 0;
}

/** Return whether the channels of a thing or a robot have the values of those chosen. @param {Run} run @param {Chosen} chosen @param {number} frame @param {number} k */
export const fits = (run, { where }, frame, k) => Object.entries(where).every(([name, [least, most]]) => {
  const value = valueAt(run, name, frame, k);
  return value >= least && value <= most;
});

/** Return the places of the chosen things at a frame, with their numbers. @param {Run} run @param {Chosen} chosen @param {number} frame @returns {[number, number, number][]} */
export function placesOf(run, chosen, frame) {
  const count = run.tracks.get(`${chosen.at}_x`)?.columns ?? 0, things = run.head.things?.filter(({ channel }) => channel === chosen.at) ?? [];
  const numbers = (chosen.numbers ?? [...Array(count).keys()]).filter((k) => fits(run, chosen, frame, k));
  return count ? numbers.map((k) => [valueAt(run, `${chosen.at}_x`, frame, k), valueAt(run, `${chosen.at}_y`, frame, k), k])
    : things.map(({ x, y, moves }, k) => (moves === undefined ? [x, y, k] : [valueAt(run, "thing_x", frame, moves), valueAt(run, "thing_y", frame, moves), k]));
}

/** Return the sign of what a robot carries at a frame; undefined for nothing. @param {Run} run @param {number} frame @param {number} robot */
export const loadOf = (run, frame, robot) => run.head.drawn?.findLast((one) => one.at === "robot" && fits(run, one, frame, robot))?.sign;

/** Return a setting of a robot, by its model where they differ. @param {Run} run @param {number} robot @param {string} key */
export function settingOf(run, robot, key) {
  const { robots } = run.head.mission;
  return (robots.groups ? robots.groups[run.head.models?.[robot] ?? 0] : robots)[key];
}

/** Return what was done by hand before the decisions of a frame. @param {Run} run @param {number} frame */
export const changesUntil = (run, frame) => [...run.byHand, ...run.coming].filter((change) => change.tick <= frame);

/**
 * Return the strategy that chose what robots hold at a frame, and the one that chooses from the next decision on.
 * @param {Run} run @param {number} frame @returns {{chose: string, next: string}}
 */
export function choosersAt(run, frame) {
  const { about, ticks_per_decision: period } = run.head, decided = Math.min(frame, run.frames - 1);
  const followed = changesUntil(run, frame).filter((change) => change.do === "follow_strategy");
  /** @param {Change | undefined} change */
  const name = (change) => change?.strategy?.split(" sha256:")[0] ?? about.condition ?? "";
  return { next: name(followed.at(-1)), chose: name(followed.findLast(({ tick }) => Math.ceil(tick / period) * period <= decided)) };
}

/** Return the title of a run at a frame, with the strategy at that time. @param {Run} run @param {number} frame */
export function titleOf(run, frame) {
  const { experiment, scenario } = run.head.about;
  return [experiment, scenario && `scenario ${scenario}`, choosersAt(run, frame).next].filter(Boolean).join(", ") || "mission";
}
