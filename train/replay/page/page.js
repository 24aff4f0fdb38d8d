// @ts-check
/** The page: plays runs on one clock, and shows what is chosen. */
import { titleOf } from "./recording.js";
import { EVENT_WORDS, countsOf, eventsOf, partingFrame } from "./course.js";
import { LOOK, WorldView, colourOf, legendOf } from "./world.js";
import { drawCurves, drawEvents, drawHeld, opinionCurves } from "./charts.js";
import { panelOf } from "./mind.js";
/** @typedef {import("./recording.js").Run} Run */
/** @typedef {{run: Run, view: WorldView, events: import("./course.js").RunEvent[], counts: {items: Float64Array, contacts: Float64Array},
 *   charts: HTMLCanvasElement[], title: HTMLElement, caption: HTMLElement}} Shown */

export const SPEEDS = [0.25, 0.5, 1, 2, 5, 10, 20, 50];
const LINE = 12; // pixels of a line of the timeline, as of its words in page.css
const PANEL_PERIOD = 120; // [ms] between two pictures of the panel while the page plays

/** Return the element of an id. @param {string} id @returns {any} */
export const element = (id) => document.getElementById(id);

/** Return a number with its noun. @param {number} count @param {string} noun */
const numbered = (count, noun) => `${count} ${noun}${count === 1 ? "" : "s"}`;

/** The page; call `start` once. */
export class Page {
  /** @param {Run[]} runs */
  constructor(runs) {
    this.period = runs[0].head.period;
    this.frames = Math.max(...runs.map((run) => run.frames + run.ahead));
    this.time = 0;
    this.robot = 0;
    this.chosen = 0;
    this.playing = false;
    this.following = false;
    this.speed = SPEEDS.indexOf(5);
    this.before = 0;
    this.panelAt = 0;
    document.body.classList.toggle("task", runs.some((run) => run.head.things));
    this.parting = runs.length > 1 ? partingFrame(runs[0], runs[1]) : -1;
    /** @type {Shown[]} */
    this.shown = runs.map((run, k) => this.build(run, k));
    /** Lines over the charts at the present time. @type {HTMLElement[]} */
    this.lines = [...document.querySelectorAll(".over")].map((over) => {
      if (this.parting > 0) this.lineOver(over, "parting").style.left = `${(100 * this.parting) / this.frames}%`;
      return this.lineOver(over, "present");
    });
  }

  /** Listen to the user, and show the moment that the address names. */
  start() {
    this.connect();
    this.size();
    this.readLink();
    this.draw();
  }

  get end() {
    return (this.frames - 1) * this.period;
  }

  /** Whether the time moves on by itself. */
  get moving() {
    return this.playing;
  }

  /** Return the frame of a run at the present time. @param {Run} run */
  frameOf(run) {
    return Math.max(0, Math.min(run.frames + run.ahead - 1, Math.floor(this.time / this.period + 1e-6)));
  }

  /** Build the figure of a run. @param {Run} run @param {number} k @returns {Shown} */
  build(run, k) {
    const figure = document.createElement("figure");
    const goal = Object.keys(run.head.options)[0], options = run.head.options[goal] ?? [];
    const held = options.map((word, k) => ({ ...LOOK.failed, word, colour: colourOf(k) }));
    figure.innerHTML = `<figcaption><b></b><span class="caption"></span></figcaption>
      <canvas class="world" tabindex="0" role="img" aria-label="The world of run ${k + 1}"></canvas>
      <div class="small legend">${legendOf([...held, ...LOOK.legends[run.head.things ? 0 : 1]])}</div>
      <h3>Option held by each robot</h3><div class="over"><canvas class="chart" height="120"></canvas></div>
      <h3>${run.head.things ? "Collisions" : "Items dumped (line), collisions (dashes)"}</h3><div class="over"><canvas class="chart" height="90"></canvas></div>
      <h3>What the chooser thinks of each option, mean of the robots</h3><div class="over"><canvas class="chart" height="90"></canvas></div>`;
    element("runs").append(figure);
    const canvas = /** @type {HTMLCanvasElement} */ (figure.querySelector(".world"));
    const charts = [...figure.querySelectorAll(".chart")].map((chart) => /** @type {HTMLCanvasElement} */ (chart));
    const view = new WorldView(run, canvas);
    this.listen(canvas, view, k);
    for (const chart of charts) this.scrubOn(chart);
    const [title, caption] = ["b", ".caption"].map((name) => /** @type {HTMLElement} */ (figure.querySelector(name)));
    const events = eventsOf(run);
    return { run, view, events, counts: countsOf(run, events), charts, title, caption };
  }

  /** Return a new vertical line over a chart. @param {Element} over @param {string} name */
  lineOver(over, name) {
    const line = document.createElement("div");
    line.className = `line ${name}`;
    over.append(line);
    return line;
  }

  /** Listen to what is done on a world: click, drag, wheel, two fingers. @param {HTMLCanvasElement} canvas @param {WorldView} view @param {number} k */
  listen(canvas, view, k) {
    /** @type {{x: number, y: number, moved: boolean} | null} */
    let drag = null;
    /** Where the mouse or fingers are down. @type {Map<number, [number, number]>} */
    const down = new Map();
    const apart = () => {
      const [[ax, ay], [bx, by]] = [...down.values()];
      return Math.max(1, Math.hypot(ax - bx, ay - by));
    };
    /** @param {PointerEvent} e @returns {[number, number]} */
    const shares = (e) => {
      const box = canvas.getBoundingClientRect();
      return [(e.clientX - box.left) / box.width, (e.clientY - box.top) / box.height];
    };
    canvas.addEventListener("pointerdown", (e) => {
      down.set(e.pointerId, [e.clientX, e.clientY]);
      canvas.setPointerCapture(e.pointerId);
      drag = down.size > 1 ? null : { x: e.clientX, y: e.clientY, moved: false };
      if (drag) this.grab(view, ...shares(e));
    });
    canvas.addEventListener("pointermove", (e) => {
      if (down.size > 1) {
        const before = apart();
        down.set(e.pointerId, [e.clientX, e.clientY]);
        this.zoomBy(view, apart() / before);
        return;
      }
      if (!drag || (!drag.moved && Math.hypot(e.clientX - drag.x, e.clientY - drag.y) < 6)) return;
      if (this.drag(view, ...shares(e))) { drag.moved = true; return; }
      const box = canvas.getBoundingClientRect(), metre = (box.width / view.run.head.width) * view.zoom;
      view.centre[0] -= (e.clientX - drag.x) / metre;
      view.centre[1] += (e.clientY - drag.y) / metre;
      drag = { x: e.clientX, y: e.clientY, moved: true };
      this.follow(false);
      this.draw();
    });
    canvas.addEventListener("pointerup", (e) => {
      if (drag && !drag.moved) this.click(k, view, ...shares(e));
      else if (drag) this.drop(view, ...shares(e));
    });
    canvas.addEventListener("lostpointercapture", (e) => { // after every end of a press, also one that is cancelled
      down.delete(e.pointerId);
      drag = null;
    });
    canvas.addEventListener("wheel", (e) => {
      e.preventDefault();
      this.zoomBy(view, e.deltaY < 0 ? 1.2 : 1 / 1.2);
    }, { passive: false });
  }

  /** Zoom a world about its centre. @param {WorldView} view @param {number} factor */
  zoomBy(view, factor) {
    view.zoom = Math.max(1, Math.min(12, view.zoom * factor));
    if (view.zoom === 1) view.centre = [view.run.head.width / 2, view.run.head.height / 2];
    this.draw();
  }

  /** Take what is at a place on the canvas [shares of its size]: nothing, in a recording. @param {WorldView} _view @param {number} _px @param {number} _py */
  grab(_view, _px, _py) {}

  /** Move what was taken; return whether there is anything. @param {WorldView} _view @param {number} _px @param {number} _py */
  drag(_view, _px, _py) {
    return false;
  }

  /** Drop what was taken. @param {WorldView} _view @param {number} _px @param {number} _py */
  drop(_view, _px, _py) {}

  /** Choose the robot at a place on the canvas of run k. @param {number} k @param {WorldView} view @param {number} px @param {number} py */
  click(k, view, px, py) {
    this.choose(k, view.nearest(px, py));
  }

  /** Let a canvas set the time. @param {HTMLCanvasElement} canvas */
  scrubOn(canvas) {
    /** @param {PointerEvent} e */
    const scrub = (e) => {
      const box = canvas.getBoundingClientRect();
      this.go(((e.clientX - box.left) / box.width) * this.end);
    };
    canvas.addEventListener("pointerdown", (e) => { canvas.setPointerCapture(e.pointerId); scrub(e); });
    canvas.addEventListener("pointermove", (e) => { if (e.buttons) scrub(e); });
  }

  connect() {
    element("time").max = String(this.end);
    element("time").step = String(this.period);
    element("time").addEventListener("input", () => this.go(Number(element("time").value)));
    element("play").addEventListener("click", () => this.toggle());
    element("speed").innerHTML = SPEEDS.map((speed, k) => `<option value="${k}">${speed}x</option>`).join("");
    element("speed").value = String(this.speed);
    element("speed").addEventListener("change", () => { this.setSpeed(Number(element("speed").value)); element("speed").blur(); });
    element("follow").addEventListener("click", () => this.follow(!this.following));
    element("theme").addEventListener("click", () => {
      const dark = this.colours().paper !== LOOK.paper;
      document.documentElement.dataset.theme = dark ? "light" : "dark";
      this.pictures();
      this.draw();
    });
    this.scrubOn(element("timeline"));
    element("timeline").height = LINE * Object.keys(EVENT_WORDS).length;
    element("timeline").style.height = `${element("timeline").height}px`;
    element("legend").innerHTML = Object.values(EVENT_WORDS).map((words) => `<span>${words}</span>`).join("");
    for (const box of document.querySelectorAll("#layers input")) box.addEventListener("change", () => this.draw());
    if (this.shown.length > 1) {
      element("parting").hidden = false;
      element("parting").textContent = this.parting < 0 ? "The runs are the same." : `The runs part at ${(this.parting * this.period).toFixed(1)} s`;
      element("parting").addEventListener("click", () => this.go(Math.max(this.parting, 0) * this.period));
    }
    addEventListener("keydown", (e) => this.press(e));
    addEventListener("hashchange", () => { this.readLink(); this.draw(); });
    addEventListener("resize", () => { this.size(); this.draw(); });
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { this.pictures(); this.draw(); });
  }

  /** @param {KeyboardEvent} e */
  press(e) {
    if (e.ctrlKey || e.metaKey || e.altKey) return;
    const robots = this.shown[this.chosen].run.head.robots, step = e.shiftKey ? 5 : 1;
    /** @type {Record<string, () => void>} */
    const keys = {
      " ": () => this.toggle(),
      ArrowRight: () => this.go(this.time + step * this.period),
      ArrowLeft: () => this.go(this.time - step * this.period),
      ArrowUp: () => this.choose(this.chosen, (this.robot + 1) % robots),
      ArrowDown: () => this.choose(this.chosen, (this.robot + robots - 1) % robots),
      Home: () => this.go(0),
      End: () => this.go(this.end),
      f: () => this.follow(!this.following),
      n: () => this.goToEvent(1),
      p: () => this.goToEvent(-1),
      r: () => this.choose((this.chosen + 1) % this.shown.length, this.robot),
      "+": () => this.setSpeed(this.speed + 1),
      "-": () => this.setSpeed(this.speed - 1),
    };
    if (!keys[e.key]) return;
    e.preventDefault(); // else the slider would move by itself, too
    keys[e.key]();
  }

  /** @param {number} speed */
  setSpeed(speed) {
    this.speed = Math.max(0, Math.min(SPEEDS.length - 1, speed));
    element("speed").value = String(this.speed);
  }

  /** Go to the next or previous event of the chosen robot. @param {number} direction */
  goToEvent(direction) {
    const { run, events } = this.shown[this.chosen], now = this.frameOf(run);
    const own = events.filter((event) => event.robot === this.robot && (direction > 0 ? event.frame > now : event.frame < now));
    const event = direction > 0 ? own[0] : own[own.length - 1];
    if (event) this.go(event.frame * this.period);
  }

  /** Show a time [s]. @param {number} time */
  go(time) {
    this.time = Math.max(0, Math.min(this.end, Math.round(time / this.period) * this.period));
    this.writeLink();
    this.draw();
  }

  /** Choose a robot of a run. @param {number} k @param {number} robot */
  choose(k, robot) {
    if (robot < 0) return;
    [this.chosen, this.robot] = [k, robot];
    this.writeLink();
    this.draw();
  }

  /** @param {boolean} wanted */
  follow(wanted) {
    this.following = wanted;
    element("follow").setAttribute("aria-pressed", String(wanted));
    if (wanted) for (const { view } of this.shown) view.zoom = Math.max(view.zoom, 2.5);
    if (wanted) this.draw();
  }

  /** Play or stop. */
  toggle() {
    this.play(!this.playing);
  }

  /** @param {boolean} wanted */
  play(wanted) {
    if (wanted && this.time >= this.end) this.time = 0;
    this.playing = wanted;
    element("play").textContent = wanted ? "Pause" : "Play";
    this.before = performance.now();
    if (wanted) requestAnimationFrame((now) => this.tick(now));
    else this.go(this.time);
  }

  /** @param {number} now [ms] */
  tick(now) {
    if (!this.playing) return;
    this.time = Math.min(this.end, this.time + (Math.max(0, now - this.before) / 1000) * SPEEDS[this.speed]);
    this.before = now;
    if (this.time >= this.end) return this.play(false);
    this.draw();
    requestAnimationFrame((later) => this.tick(later));
  }

  readLink() {
    const given = new URLSearchParams(location.hash.slice(1));
    const robots = this.shown[0].run.head.robots;
    this.time = Math.max(0, Math.min(this.end, Number(given.get("t")) || 0));
    this.robot = Math.max(0, Math.min(robots - 1, Math.floor(Number(given.get("robot")) || 0)));
    this.chosen = Math.max(0, Math.min(this.shown.length - 1, Math.floor(Number(given.get("run")) || 0)));
  }

  writeLink() {
    if (this.moving) return;
    const run = this.shown.length > 1 ? `&run=${this.chosen}` : "";
    history.replaceState(null, "", `#t=${Number(this.time.toFixed(3))}&robot=${this.robot}${run}`);
  }

  colours() {
    const style = getComputedStyle(document.documentElement);
    /** @param {string} name */
    const of = (name) => style.getPropertyValue(name).trim();
    return { ink: of("--ink"), paper: of("--paper"), faint: of("--faint") };
  }

  /** Fit the canvases to the window. */
  size() {
    for (const { run, view, charts } of this.shown) {
      const width = Math.max(240, Math.min(900, Math.round(view.canvas.clientWidth || 600)));
      view.canvas.width = width;
      view.canvas.height = Math.round((width * run.head.height) / run.head.width);
      for (const chart of charts) chart.width = width;
    }
    element("timeline").width = Math.max(300, Math.round(element("timeline").clientWidth));
    this.pictures();
  }

  /** Draw what does not change with the time. */
  pictures() {
    const most = Math.max(...this.shown.map(({ counts }) => counts.contacts[counts.contacts.length - 1] ?? 0), 1);
    const items = Math.max(...this.shown.map(({ run, counts }) => Math.max(run.head.items, counts.items[counts.items.length - 1] ?? 0)), 1);
    for (const { run, counts, charts } of this.shown) {
      const curves = [{ values: counts.contacts, colour: LOOK.contact, dash: [5, 4], most }];
      if (!run.head.things) curves.unshift({ values: counts.items, colour: LOOK.attracts, dash: [], most: items });
      drawHeld(run, this.frames, charts[0]);
      drawCurves(curves, this.frames, charts[1]);
      drawCurves(opinionCurves(run, charts[2].width), this.frames, charts[2]);
    }
    drawEvents(this.shown[this.chosen].events, this.frames, element("timeline"), this.colours().ink);
    this.timelineOf = this.chosen;
  }

  draw() {
    const colours = this.colours();
    /** @type {any} */
    const layers = Object.fromEntries([...document.querySelectorAll("#layers input")].map((box) => [/** @type {HTMLInputElement} */ (box).name, /** @type {HTMLInputElement} */ (box).checked]));
    element("time").value = String(this.time);
    element("now").textContent = `${this.time.toFixed(1)} s`;
    this.shown.forEach(({ run, view, counts, title, caption }, k) => {
      const frame = this.frameOf(run), counted = Math.min(frame, run.frames - 1, counts.items.length - 1), share = this.playing ? this.time / this.period - Math.floor(this.time / this.period) : 0;
      if (this.following && this.robot < run.head.robots) { view.pose(frame, share); view.centre = [view.x[this.robot], view.y[this.robot]]; }
      view.draw(frame, share, this.robot, layers, colours);
      const over = this.time >= (run.frames - 1) * this.period && run.result;
      const done = [numbered(counts.contacts[counted] ?? 0, "collision")]; // nothing is counted before the first step
      if (!run.head.things) done.unshift(`${numbered(counts.items[counted] ?? 0, "item")} dumped`);
      if (over) done.push(...Object.entries(run.result?.measures ?? {}).map(([name, value]) => `${name} ${Number(value.toPrecision(3))}`));
      if (over) done.push(run.result?.completed ? `completed after ${run.result.duration_s} s` : "not completed");
      title.textContent = titleOf(run, frame);
      caption.textContent = done.join(", ");
      view.canvas.classList.toggle("chosen", k === this.chosen && this.shown.length > 1);
    });
    if (this.timelineOf !== this.chosen) this.pictures();
    const share = (100 * this.time) / this.period / this.frames;
    for (const line of this.lines) line.style.left = `${share}%`;
    if (!this.moving || performance.now() - this.panelAt > PANEL_PERIOD) {
      const { run } = this.shown[this.chosen];
      element("panel").innerHTML = panelOf(run, this.frameOf(run), Math.min(this.robot, run.head.robots - 1));
      this.panelAt = performance.now();
    }
  }

  /** Return the milliseconds of one picture while the page plays, the mean of some. @param {number} pictures */
  measure(pictures) {
    const begin = performance.now(), time = this.time;
    this.playing = true;
    for (let k = 0; k < pictures; k++) {
      this.time = (time + k * this.period) % Math.max(this.end, this.period);
      this.draw();
      for (const { view } of this.shown) view.canvas.getContext("2d")?.getImageData(0, 0, 1, 1); // else drawing is put off
    }
    const spent = (performance.now() - begin) / pictures;
    this.playing = false;
    this.time = time;
    return spent;
  }
}
