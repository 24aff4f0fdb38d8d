// @ts-check
/** The beginning: shows the recordings that the page holds, or the session of the server that it comes from. */
import { bytesOf, checksums, readRecording } from "./recording.js";
import { Page, element } from "./page.js";
import { follow } from "./live.js";

try {
  const page = element("live") ? await follow() : new Page(
    await Promise.all([...document.querySelectorAll("script[type='text/plain']")].map((file) => readRecording(bytesOf(file.textContent ?? "")))),
  );
  page.start();
  const runs = page.shown.map(({ run }) => run);
  Object.assign(globalThis, { replay: { page, runs, checksums: () => runs.map(checksums), events: () => page.shown.map(({ events }) => events) } });
  document.body.dataset.ready = "true";
} catch (error) {
  element("panel").textContent = `The recording cannot be shown: ${error instanceof Error ? error.message : error}`;
  throw error;
}
