// @ts-check
/** The controls of the page: buttons, keys, and what sets the time. */
import { LOOK } from "./look.js";
import { explainWords } from "./words.js";
/** @typedef {import("./page.js").Page} Page */

export const SPEEDS = [0.25, 0.5, 1, 2, 5, 10, 20, 50];
export const WIDE = matchMedia("(min-width: 901px)"); // as in page.css

/** Return the element of an id. @param {string} id @returns {any} */
export const element = (id) => document.getElementById(id);

/** Write HTML where it differs from what is there: a tooltip would vanish. @param {HTMLElement} place @param {string} html */
export function put(place, html) {
  if (place.dataset.html === html) return;
  place.innerHTML = html;
  place.dataset.html = html;
}

/** Show a speed in the list of speeds, which has it from then on, and return its place there. @param {number} speed */
export function showSpeed(speed) {
  if (!SPEEDS.includes(speed)) SPEEDS.push(speed);
  SPEEDS.sort((a, b) => a - b);
  put(element("speed"), SPEEDS.map((one, k) => `<option value="${k}">${one}x</option>`).join(""));
  const place = SPEEDS.indexOf(speed);
  element("speed").value = String(place);
  return place;
}

/** Let the page listen to its controls. @param {Page} page */
export function connect(page) {
  explainWords(document);
  element("time").max = String(page.end);
  element("time").step = String(page.period);
  element("time").addEventListener("input", () => page.go(Number(element("time").value)));
  element("play").addEventListener("click", () => page.toggle());
  showSpeed(SPEEDS[page.speed]);
  let pointed = false; // a key that chooses a speed may choose another one
  for (const kind of ["pointerdown", "keydown"]) addEventListener(kind, () => { pointed = kind === "pointerdown"; }, true);
  element("speed").addEventListener("change", () => { page.setSpeed(Number(element("speed").value)); if (pointed) element("speed").blur(); });
  /** @param {PointerEvent | MouseEvent} e */
  const turn = (e) => {
    const robots = page.shown[page.chosen].run.head.robots, by = Number(/** @type {HTMLElement} */ (e.target).dataset.turn ?? 0);
    if (by) page.choose(page.chosen, (page.robot + robots + by) % robots);
  };
  element("panel").addEventListener("pointerdown", turn); // the panel may be drawn anew before a click is whole
  element("panel").addEventListener("click", (/** @type {MouseEvent} */ e) => { if (!e.detail) turn(e); }); // by a key
  element("follow").addEventListener("click", () => page.follow(!page.following));
  element("whole").addEventListener("click", () => { page.follow(false); for (const { view } of page.shown) page.zoomBy(view, 0); });
  element("goal").addEventListener("change", () => { page.colourBy(element("goal").value); page.pictures(); page.panelAt = 0; page.draw(); });
  element("theme").addEventListener("click", () => {
    const dark = page.colours().paper !== LOOK.paper;
    document.documentElement.dataset.theme = dark ? "light" : "dark";
    page.pictures();
    page.draw();
  });
  scrubOn(page, element("timeline"));
  for (const box of document.querySelectorAll("[data-layer]")) box.addEventListener("change", () => page.draw());
  if (page.shown.length > 1) {
    element("parting").hidden = false;
    element("parting").textContent = page.parting < 0 ? "The runs are the same." : `The runs part at ${(page.parting * page.period).toFixed(1)} s`;
    element("parting").addEventListener("click", () => page.go(Math.max(page.parting, 0) * page.period));
  }
  addEventListener("keydown", (e) => press(page, e));
  addEventListener("click", (e) => { // by a mouse, not by a key: space plays again
    const pressed = /** @type {HTMLElement | null} */ (/** @type {HTMLElement} */ (e.target).closest?.("button, summary"));
    if (e.detail) pressed?.blur();
  });
  addEventListener("hashchange", () => { page.readLink(); page.draw(); });
  addEventListener("resize", () => { page.size(); page.draw(); });
  for (const group of document.querySelectorAll("details")) group.addEventListener("toggle", () => { page.size(); page.draw(); });
  WIDE.addEventListener("change", () => fold(page));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { page.pictures(); page.draw(); });
}

/** Fold the groups of controls on a phone, and unfold them where there is room. @param {Page} page */
export function fold(page) {
  for (const group of document.querySelectorAll("details"))
    /** @type {HTMLDetailsElement} */ (group).open = WIDE.matches && (group.id !== "keys" || page.shown.length === 1);
}

/** Let a canvas set the time. @param {Page} page @param {HTMLCanvasElement} canvas */
export function scrubOn(page, canvas) {
  /** @param {PointerEvent} e */
  const scrub = (e) => {
    const box = canvas.getBoundingClientRect();
    page.go(((e.clientX - box.left) / box.width) * page.end);
  };
  canvas.addEventListener("pointerdown", (e) => { canvas.setPointerCapture(e.pointerId); scrub(e); });
  canvas.addEventListener("pointermove", (e) => { if (e.buttons) scrub(e); });
}

/** Do what a key does. @param {Page} page @param {KeyboardEvent} e */
function press(page, e) {
  if (e.ctrlKey || e.metaKey || e.altKey) return;
  const on = /** @type {HTMLElement} */ (e.target), control = on.closest?.("button, select, summary, input:not(#time)");
  if (control && (e.key === " " || (e.key.startsWith("Arrow") && on.matches("select, input")))) return; // it has these keys itself
  const robots = page.shown[page.chosen].run.head.robots, step = e.shiftKey ? 5 : 1;
  /** @type {Record<string, () => void>} */
  const keys = {
    " ": () => page.toggle(),
    ArrowRight: () => page.go(page.time + step * page.period),
    ArrowLeft: () => page.go(page.time - step * page.period),
    ArrowUp: () => page.choose(page.chosen, (page.robot + 1) % robots),
    ArrowDown: () => page.choose(page.chosen, (page.robot + robots - 1) % robots),
    Home: () => page.go(0),
    End: () => page.go(page.end),
    f: () => page.follow(!page.following),
    n: () => page.goToEvent(1),
    p: () => page.goToEvent(-1),
    r: () => page.choose((page.chosen + 1) % page.shown.length, page.robot),
    "+": () => page.setSpeed(page.speed + 1),
    "-": () => page.setSpeed(page.speed - 1),
  };
  if (!keys[e.key]) return;
  e.preventDefault(); // else the slider would move by itself, too
  keys[e.key]();
}
