// @ts-check
/** The page: plays runs on one clock, and shows what is chosen. */
import { titleOf, valueAt } from "./recording.js";
import { countMore, eventsOf, goalShown, kindsOf, partingFrame } from "./course.js";
import { LOOK, plain } from "./look.js";
import { WorldView } from "./world.js";
import { CHART_WORDS } from "./words.js";
import { drawCurves, drawEvents, drawHeld, opinionCurves } from "./charts.js";
import { panelOf } from "./mind.js";
import { scoreOf } from "./score.js";
import { listenTo } from "./pointer.js";
import { drawWhy } from "./why.js";
import { SPEEDS, WIDE, connect, element, fold, put, scrubOn } from "./controls.js";
import { offerLayers, showLegend } from "./layers.js";
/** @typedef {import("./recording.js").Run} Run */
/** @typedef {{run: Run, view: WorldView, events: import("./course.js").RunEvent[], counts: import("./course.js").Counts,
 *   charts: HTMLCanvasElement[], title: HTMLElement, caption: HTMLElement, score: HTMLElement}} Shown */

const LINE = 12; // pixels of a line of the timeline, as of its words in page.css
const PANEL_PERIOD = 120; // [ms] between two pictures of the panel while the page plays
const LEAST_WORLD = 200; // [pixels] height of a world where there is no room

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
    /** Kinds of events that have a line. @type {string[]} */
    this.kinds = [];
    document.body.classList.toggle("task", runs.some((run) => run.head.things));
    document.body.classList.toggle("two", runs.length > 1);
    this.parting = runs.length > 1 ? partingFrame(runs[0], runs[1]) : -1;
    offerLayers(runs);
    /** @type {Shown[]} */
    this.shown = runs.map((run, k) => this.build(run, k));
    this.colourBy(goalShown(runs));
    /** Lines over the charts at the present time. @type {HTMLElement[]} */
    this.lines = [...document.querySelectorAll(".over")].map((over) => {
      if (this.parting > 0) this.lineOver(over, "parting").style.left = `${(100 * this.parting) / this.frames}%`;
      return this.lineOver(over, "present");
    });
  }

  /** Listen to the user, and show the moment that the address names. */
  start() {
    connect(this);
    fold(this);
    this.readLink();
    this.size();
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
    const titles = ["Option held by each robot", !run.tracks.has("dumped") ? "Collisions" : "Items dumped (line), collisions (dashes)", "What the chooser thinks of each option, averaged over robots"];
    figure.innerHTML = `<figcaption><b></b><span class="caption"></span></figcaption><div class="score"></div>
      <div class="stage"><canvas class="world" tabindex="0" role="img" aria-label="The world of run ${k + 1}"></canvas></div>
      <details class="charts"><summary>Charts</summary>
      ${titles.map((title, c) => `<h3 title="${CHART_WORDS[c]}">${title}</h3><div class="over"><canvas class="chart" height="${c ? 90 : 120}"></canvas></div>`).join("")}</details>`;
    element("runs").append(figure);
    const canvas = /** @type {HTMLCanvasElement} */ (figure.querySelector(".world"));
    const charts = [...figure.querySelectorAll(".chart")].map((chart) => /** @type {HTMLCanvasElement} */ (chart));
    const view = new WorldView(run, canvas);
    view.over.push(drawWhy);
    listenTo(canvas, view, k, this, element("hint"));
    for (const chart of charts) scrubOn(this, chart);
    const [title, caption, score] = ["b", ".caption", ".score"].map((name) => /** @type {HTMLElement} */ (figure.querySelector(name)));
    /** @type {import("./course.js").Counts} */
    const counts = { items: [], contacts: [] };
    countMore(run, counts);
    return { run, view, events: eventsOf(run), counts, charts, title, caption, score };
  }

  /** Return a new vertical line over a chart. @param {Element} over @param {string} name */
  lineOver(over, name) {
    const line = document.createElement("div");
    line.className = `line ${name}`;
    over.append(line);
    return line;
  }

  /** Give robots the colours of the options of a goal. @param {string} goal */
  colourBy(goal) {
    element("goal").value = goal;
    for (const { run } of this.shown) if (run.head.options[goal]) run.goal = goal;
  }

  /** Zoom a world about its centre. @param {WorldView} view @param {number} factor */
  zoomBy(view, factor) {
    view.zoom = Math.max(1, Math.min(12, view.zoom * factor));
    if (view.zoom === 1) view.centre = view.middle;
    this.draw();
  }

  /** Move what is seen of a world [m]. @param {WorldView} view @param {number} dx @param {number} dy */
  moveBy(view, dx, dy) {
    view.centre[0] -= dx;
    view.centre[1] += dy;
    this.follow(false);
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

  /** Choose the robot at a place on the canvas of run k; nothing where none is near. @param {number} k @param {WorldView} view @param {number} px @param {number} py */
  click(k, view, px, py) {
    const { kind, number } = view.thingAt(px, py, this.frameOf(view.run));
    if (kind === "robot") this.choose(k, number);
  }

  /** Return what is shown above the panel of the robot, as HTML. */
  beside() {
    return "";
  }

  /** Return what a press would do. @param {WorldView} view @param {number} px @param {number} py @returns {import("./pointer.js").Hint} */
  hint(view, px, py) {
    const { kind, number } = view.thingAt(px, py, this.frameOf(view.run));
    if (number < 0) return { cursor: "move", words: "" };
    return kind === "robot" ? { cursor: "pointer", words: `a click chooses robot ${number}${this.heldBy(view.run, number)}` } : { cursor: "default", words: `item ${number}` };
  }

  /** Return what a robot holds now, in brackets. @param {Run} run @param {number} robot */
  heldBy(run, robot) {
    const held = Object.entries(run.head.options).map(([goal, options]) => options[valueAt(run, `held/${goal}`, this.frameOf(run), robot)]);
    return held.length ? ` (${held.join(", ")})` : "";
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
    [this.chosen, this.robot, this.panelAt] = [k, robot, 0];
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
    const { run } = this.shown[0], works = Array.from({ length: robots }, (_, robot) => valueAt(run, "working", 0, robot) > 0);
    const wanted = given.has("robot") ? Math.floor(Number(given.get("robot")) || 0) : works.indexOf(true);
    this.robot = Math.max(0, Math.min(robots - 1, wanted));
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
    return { ink: of("--ink"), paper: of("--paper"), faint: of("--faint"), rim: of("--rim") };
  }

  /** Fit the canvases to the window: the world gets the height that is free, charts are below it. */
  size() {
    this.listKinds();
    element("timeline").width = Math.max(200, Math.round(element("timeline").clientWidth));
    const runs = element("runs");
    for (const { view, charts } of this.shown) {
      const stage = /** @type {HTMLElement} */ (view.canvas.parentElement), above = stage.getBoundingClientRect().top;
      const free = WIDE.matches ? runs.getBoundingClientRect().bottom - above - runs.scrollTop - 6 : innerHeight - above - scrollY - 6;
      view.fit(stage.clientWidth, Math.max(LEAST_WORLD, free));
      for (const chart of charts) chart.width = Math.max(120, Math.round(stage.clientWidth));
    }
    this.pictures();
  }

  /** Give each kind of events that there is a line in the timeline; return whether another one has come. */
  listKinds() {
    const all = kindsOf(this.shown.map(({ run }) => run)), kinds = [...all.keys()].filter((kind) => this.shown.some(({ events }) => events.some((event) => event.kind === kind)));
    if (element("kinds").childElementCount && kinds.join() === this.kinds.join()) return false;
    this.kinds = kinds;
    const words = kinds.map((kind) => all.get(kind) ?? ["", ""]);
    element("kinds").innerHTML = words.map(([word, about]) => `<span title="${plain(about)}">${plain(word)}</span>`).join("") || "<span>no event yet</span>";
    element("timeline").height = LINE * Math.max(1, kinds.length);
    element("timeline").style.height = `${element("timeline").height}px`;
    return true;
  }

  /** Draw what does not change with the time. */
  pictures() {
    showLegend(this.shown.map(({ run }) => run));
    const most = Math.max(...this.shown.map(({ counts }) => counts.contacts[counts.contacts.length - 1] ?? 0), 1);
    const items = Math.max(...this.shown.map(({ run, counts }) => Math.max(run.head.prices?.items || run.head.items, counts.items[counts.items.length - 1] ?? 0)), 1);
    for (const { run, counts, charts } of this.shown) {
      const curves = [{ values: counts.contacts, colour: LOOK.contact, dash: [5, 4], most }];
      if (run.tracks.has("dumped")) curves.unshift({ values: counts.items, colour: LOOK.areas[0].colour, dash: [], most: items });
      drawHeld(run, this.frames, charts[0]);
      drawCurves(curves, this.frames, charts[1]);
      drawCurves(opinionCurves(run, charts[2].width), this.frames, charts[2]);
    }
    drawEvents(this.shown[this.chosen].events, this.kinds, this.frames, element("timeline"), this.colours().ink);
    this.timelineOf = this.chosen;
  }

  draw() {
    const colours = this.colours();
    const layers = Object.fromEntries([...document.querySelectorAll("[data-layer]")].map((box) => [/** @type {HTMLInputElement} */ (box).name, /** @type {HTMLInputElement} */ (box).checked]));
    element("time").value = String(this.time);
    element("now").textContent = `${this.time.toFixed(1)} s`;
    this.shown.forEach(({ run, view, counts, title, caption, score }, k) => {
      const frame = this.frameOf(run), counted = Math.min(frame, run.frames - 1), share = this.playing ? this.time / this.period - Math.floor(this.time / this.period) : 0;
      if (this.following && this.robot < run.head.robots) { view.pose(frame, share); view.centre = [view.x[this.robot], view.y[this.robot]]; }
      view.draw(frame, share, this.robot, layers, colours);
      const over = this.time >= (run.frames - 1) * this.period && run.result, done = [];
      if (over) done.push(...Object.entries(run.result?.measures ?? {}).map(([name, value]) => `${name} ${Number(value.toPrecision(3))}`));
      if (over) done.push(run.result?.completed ? `completed after ${run.result.duration_s} s` : "not completed");
      title.textContent = title.title = titleOf(run, frame);
      caption.textContent = caption.title = done.join(", ");
      put(score, scoreOf(run, counts, counted, over ? run.result?.duration_s : frame * this.period));
      view.canvas.classList.toggle("chosen", k === this.chosen && this.shown.length > 1);
    });
    if (this.timelineOf !== this.chosen) this.pictures();
    const share = (100 * this.time) / this.period / this.frames;
    for (const line of this.lines) line.style.left = `${share}%`;
    if (!this.moving || performance.now() - this.panelAt > PANEL_PERIOD) {
      const { run } = this.shown[this.chosen];
      const open = [...element("panel").querySelectorAll("details[open]")].map((one) => one.className);
      put(element("panel"), panelOf(run, this.frameOf(run), Math.min(this.robot, run.head.robots - 1), this.beside()));
      for (const one of element("panel").querySelectorAll("details")) one.open = open.includes(one.className);
      this.panelAt = performance.now();
    }
  }

  /** Return the milliseconds of one picture while the page plays, the median of some. @param {number} pictures */
  measure(pictures) {
    const time = this.time, spent = [];
    this.playing = true;
    for (let k = 0; k < pictures; k++) {
      const begin = performance.now();
      this.time = (time + k * this.period) % Math.max(this.end, this.period);
      this.draw();
      for (const { view } of this.shown) view.canvas.getContext("2d")?.getImageData(0, 0, 1, 1); // else drawing is put off
      spent.push(performance.now() - begin);
    }
    this.playing = false;
    this.time = time;
    return spent.sort((a, b) => a - b)[Math.floor(pictures / 2)];
  }
}
