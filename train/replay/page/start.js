// @ts-check
/** The beginning of all pages: of recordings, and of a session whose frames come from its server. */
import { addBlock, blocksIn, bytesOf, checksums, readRecording, showPresent } from "./recording.js";
import { factsOf, sentenceOf } from "./why.js";
import { movesOf } from "./policy.js";
import { placeOf } from "./floor.js";
import { element } from "./controls.js";
import { Page } from "./page.js";
import { GONE, LivePage } from "./live.js";
/** @typedef {import("./recording.js").Run} Run */
/** @typedef {import("./live.js").State} State */

const OTHER = "This session is over, or another one answers there: open the address that clean-swarm play prints. What came until now stays.";

/** Follow the session of the server; return its page when there is something to see. @returns {Promise<LivePage>} */
function follow() {
  const source = new EventSource(`/events${location.search}`);
  /** @type {Run | null} */
  let run = null;
  /** @type {LivePage | null} */
  let page = null;
  /** @type {State | null} */
  let state = null;
  /** Blocks that have come and are not in the run yet. @type {Uint8Array[]} */
  let come = [];
  let taking = false;
  /** The present, until it is shown. @type {Uint8Array | null} */
  let present = null;
  /** @param {string} words */
  const say = (words) => (page ? page.say(words) : void (element("panel").textContent = words || "Waiting for the world."));
  source.addEventListener("open", () => say(""));
  source.addEventListener("error", () => say(source.readyState === EventSource.CLOSED ? OTHER : GONE));
  return new Promise((ready, failed) => {
    const take = async () => {
      while (come.length || state?.now) {
        const coming = come;
        come = [];
        if (!run && coming.length) run = await readRecording(/** @type {Uint8Array} */ (coming.shift()));
        if (!run || !state) break;
        for (const blocks of await Promise.all(coming.map(blocksIn))) for (const [kind, content] of blocks) addBlock(run, kind, content);
        const { now: block } = state;
        state.now = "";
        if (block) [[, present]] = await blocksIn(bytesOf(block));
        if (present && (run.result?.completed || showPresent(run, present))) present = null; // what was completed has no present after it
        if (page) page.grow();
        else if (run.frames + run.ahead) ready((page = new LivePage(run, state)));
      }
    };
    const look = () => {
      if (taking) return;
      taking = true;
      take().catch(failed).finally(() => { taking = false; });
    };
    source.addEventListener("state", (event) => {
      const before = state?.number;
      state = /** @type {State} */ (JSON.parse(event.data));
      if (before && before !== state.number) { source.close(); location.reload(); return; } // another session runs now
      if (page) page.state = state;
      if (page) page.show();
      look();
    });
    source.addEventListener("message", (event) => {
      come.push(bytesOf(event.data));
      look();
    });
  });
}

try {
  const page = element("live") ? await follow() : new Page(
    await Promise.all([...document.querySelectorAll("script[type='text/plain']")].map((file) => readRecording(bytesOf(file.textContent ?? "")))),
  );
  page.start();
  const runs = page.shown.map(({ run }) => run);
  Object.assign(globalThis, { replay: { page, runs, checksums: () => runs.map(checksums), events: () => page.shown.map(({ events }) => events), factsOf, sentenceOf, movesOf, placeOf } });
  document.body.dataset.ready = "true";
} catch (error) {
  element("panel").textContent = `The recording cannot be shown: ${error instanceof Error ? error.message : error}`;
  throw error;
}
