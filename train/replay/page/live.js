// @ts-check
/** The page of a session that runs now, which takes frames from its server and gives it orders. */
import { settingOf } from "./recording.js";
import { countMore, eventsOf } from "./course.js";
import { LOOK, plain } from "./look.js";
import { verdictOf } from "./score.js";
import { drawForetold, foretoldOf } from "./foretold.js";
import { SPEEDS, element, put, showSpeed } from "./controls.js";
import { Page } from "./page.js";
/** @typedef {import("./recording.js").Run} Run */
/** @typedef {import("./world.js").WorldView} WorldView */
/**
 * @typedef {{playing: boolean, begins: boolean, speed: number, over: boolean, failure: string, strategy: string, loss: number, number: number, name: string,
 *   strategies: string[], best: string, jams: string, missions: string[], now: string}} State of the session, the `number`th of its server;
 *   begins: whether it plays as soon as somebody sees it; best: the strategy that is known to be best, jams: one with which the mission jams; now: a block in base64
 */
/** @typedef {{kind: "robot" | "item", number: number, x: number, y: number}} Held a robot or an item at a place [m] */

const CHARTS_PERIOD = 500; // [ms] between two pictures of the charts
const MOST_LAGS = 1000;
const RUNNING = ["play", "pause", "step", "speed", "what_if"]; // orders that change nothing in the world
const KINDS = { policy: "trained", learned: "trained", fsm: "rules", fixed: "one option for ever" }; // of strategies, by the beginning of their names
export const GONE = "The server does not answer. The page tries again; what came until now stays.";

/** A page whose run grows. */
export class LivePage extends Page {
  /** @param {Run} run @param {State} state */
  constructor(run, state) {
    super([run]);
    this.run = run;
    this.state = state;
    this.atHead = true;
    this.waiting = false;
    this.chartsAt = 0;
    this.made = 0;
    /** Milliseconds from the making of each frame until it was on the screen. @type {number[]} */
    this.lags = [];
    /** What is being dragged. @type {Held | null} */
    this.taken = null;
    /** What is drawn where it is dragged, and stays there until the next frame. @type {Held | null} */
    this.held = null;
    /** What was foretold last. @type {import("./foretold.js").Answer | null} */
    this.foretold = null;
    this.shown[0].view.over.push((view) => { if (this.foretold) drawForetold(view, this.foretold); });
    /** Where the verdict is shown, and the plays of this mission before. @type {HTMLElement} */
    this.stage = /** @type {HTMLElement} */ (this.shown[0].view.canvas.parentElement);
    this.banner = this.stage.appendChild(Object.assign(document.createElement("div"), { className: "banner" }));
    this.verdict = this.stage.appendChild(Object.assign(document.createElement("div"), { className: "verdict", hidden: true }));
    const options = Object.values(run.head.options)[0] ?? [];
    /** @param {string} name */
    const choice = (name) => `<option>${plain(name)}</option>`;
    /** @param {string} name */
    const kindOf = (name) => /** @type {Record<string, string>} */ (KINDS)[name.split(":")[0]] ?? "others";
    const groups = [...new Set(state.strategies.map(kindOf))].map((kind) =>
      `<optgroup label="${kind}">${state.strategies.filter((name) => kindOf(name) === kind).map(choice).join("")}</optgroup>`);
    element("option").innerHTML = ["", ...options].map((name) => `<option value="${plain(name)}">${plain(name || "as the strategy chooses")}</option>`).join("");
    element("strategy").innerHTML = groups.join("");
    element("mission").innerHTML = state.missions.map(choice).join("");
    element("mission").value = state.name || run.head.about.experiment;
    element("jam").hidden = !state.jams;
    document.title = `Clean Swarm: ${run.head.about.experiment}, live`;
    document.body.dataset.live = "true";
  }

  get moving() {
    return this.state.playing && this.atHead;
  }

  start() {
    super.start();
    this.go(this.end);
    /** @param {string} id @param {string} event @param {() => Record<string, any>} order */
    const on = (id, event, order) => element(id).addEventListener(event, () => this.order(order()));
    on("step", "click", () => ({ do: "step" }));
    on("fail", "click", () => ({ do: "fail_robot", robot: this.robot }));
    on("remove", "click", () => ({ do: "remove_robot", robot: this.robot }));
    on("strategy", "change", () => ({ do: "follow_strategy", strategy: element("strategy").value }));
    on("loss", "change", () => ({ do: "set_loss", loss: Number(element("loss").value) }));
    on("hold", "click", () => ({ do: "hold_option", option: element("option").value, robots: [this.robot] }));
    on("hold_all", "click", () => ({ do: "hold_option", option: element("option").value }));
    element("what_if").addEventListener("click", () => this.askWhatIf());
    on("again", "click", () => ({ do: "open", name: this.state.name, strategy: this.state.strategies.includes(this.state.strategy) ? this.state.strategy : "" }));
    on("jam", "click", () => ({ do: "open", name: this.state.name, strategy: this.contrast.strategy }));
    on("open", "click", () => ({ do: "open", name: element("mission").value }));
    this.verdict.addEventListener("click", (e) => {
      const { press } = /** @type {HTMLElement} */ (e.target).dataset, other = this.verdict.querySelector("select");
      if (press === "close") this.verdict.hidden = true;
      if (press === "again" || press === "jam") element(press).click();
      if (press === "open" && other) this.order({ do: "open", name: other.value });
    });
    element("head").addEventListener("click", () => this.go(this.end));
    this.show();
    const begin = () => void (this.state.begins && !this.run.frames && this.order({ do: "play" }));
    if (document.hidden) document.addEventListener("visibilitychange", begin, { once: true });
    else begin();
  }

  /** Show how the session runs. */
  show() {
    if (this.state.failure) this.say(this.state.failure);
    element("play").textContent = this.state.over ? "Over" : this.state.playing ? "Pause" : "Play";
    element("play").disabled = element("step").disabled = this.state.over;
    this.speed = showSpeed(this.state.speed);
    element("strategy").value = this.state.strategy;
    element("jam").textContent = `${this.contrast.words} (${this.contrast.strategy})`;
    const waits = !this.state.playing && !this.state.over && this.atHead, begun = this.run.frames > 0;
    this.banner.hidden = !waits;
    this.banner.textContent = begun ? "Paused. Space goes on." : "Ready: press Play or space. Robots and items can be dragged first.";
    if (this.state.over && !this.state.failure && this.run.result) this.judge();
    element("loss").value = String(this.state.loss);
    element("loss_now").textContent = `${Math.round(100 * this.state.loss)} %`;
  }

  /** The strategy that is worth watching beside the present one, and how it is offered. */
  get contrast() {
    const { strategy, jams, best } = this.state;
    return strategy === jams ? { strategy: best, words: "Watch the best" } : { strategy: jams, words: "Watch it jam" };
  }

  /** Show how the mission went beside earlier plays of it in this tab, and what can be done next; once. */
  judge() {
    if (this.verdict.dataset.judged) return;
    const { words, cost, done } = verdictOf(this.run), { name, strategy, missions, jams } = this.state, key = `plays of ${name || this.run.head.about.experiment}`;
    const own = { strategy: this.run.byHand.some((change) => change.do !== "follow_strategy") ? `${strategy}, with your help` : strategy, cost };
    const before = /** @type {{strategy: string, cost: number}[]} */ (JSON.parse(sessionStorage.getItem(key) ?? "[]"));
    sessionStorage.setItem(key, JSON.stringify([...before, own].slice(-8)));
    const rows = [...before, own].sort((a, b) => a.cost - b.cost).map((play) =>
      `<tr class="${play === own ? "run" : ""}"><td>${plain(play.strategy)}</td><td class="n">${Math.round(play.cost).toLocaleString("en")} s</td></tr>`);
    const next = missions[(missions.indexOf(name || this.run.head.about.experiment) + 1) % missions.length];
    put(this.verdict, `<button class="close" data-press="close" aria-label="Close">&times;</button><h2>${done ? "&#10003; " : ""}${plain(words)}</h2>
      <p>It cost ${Math.round(cost).toLocaleString("en")} s${this.run.head.things ? "" : " of time, collisions and items left"}. ${before.length ? "All plays here, the cheapest first:" : ""}</p>
      <table>${before.length ? rows.join("") : ""}</table><div class="together"><button data-press="again">Again</button>
      ${jams ? `<button data-press="jam">${this.contrast.words}</button>` : ""}</div>
      <div class="together"><select aria-label="Another mission">${missions.map((one) => `<option ${one === next ? "selected" : ""}>${plain(one)}</option>`).join("")}</select>
      <button data-press="open">Another mission</button></div>`);
    this.verdict.dataset.judged = "true";
    this.verdict.hidden = false;
  }

  /** Say something to the user; nothing ends it. @param {string} words */
  say(words) {
    element("said").textContent = words;
  }

  /** Have the server do something; return its answer, nothing if it refuses. @param {Record<string, any>} order @returns {Promise<any>} */
  async order(order) {
    let told = null;
    try {
      const answer = await fetch(`/do${location.search}`, { method: "POST", body: JSON.stringify(order) });
      const content = await answer.json();
      this.say(answer.ok ? "" : content.error);
      if (!answer.ok) this.held = null;
      else if (order.do === "open") location.reload();
      else if (!RUNNING.includes(order.do)) this.foretold = null; // it told of the world before
      else told = content;
    } catch {
      this.say(GONE);
    }
    this.draw();
    return told;
  }

  /** Show what the chosen robot would do under each option; the world waits, else it would be over soon. */
  async askWhatIf() {
    const robot = this.robot;
    this.go(this.end);
    if (this.state.playing) await this.order({ do: "pause" });
    const told = await this.order({ do: "what_if", robot });
    this.foretold = told && { robot, time: this.run.frames * this.period, options: told.options };
    this.panelAt = 0;
    this.draw();
  }

  beside() {
    return this.foretold ? foretoldOf(this.foretold) : "";
  }

  toggle() {
    this.foretold = null;
    this.go(this.end);
    this.order({ do: this.state.playing ? "pause" : "play" });
  }

  /** @param {number} speed */
  setSpeed(speed) {
    super.setSpeed(speed);
    this.order({ do: "speed", speed: SPEEDS[this.speed] });
  }

  /** @param {number} time */
  go(time) {
    if (this.atHead && !this.state.playing && time > this.end + this.period / 2 && time < Infinity) this.order({ do: "step" });
    super.go(time);
    this.atHead = this.time >= this.end - this.period / 2;
    if (!this.atHead) this.verdict.hidden = true; // it would cover what one looks back at
    element("head").setAttribute("aria-pressed", String(this.atHead));
    this.show();
  }

  /** Show the frames that have come, in the next picture. */
  grow() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.frames = this.run.frames + this.run.ahead;
      element("time").max = String(this.end);
      countMore(this.run, this.shown[0].counts);
      if (!this.taken) this.held = null; // what was dropped is in the world
      if (this.atHead) this.time = this.end;
      const now = performance.now();
      if (now - this.chartsAt > CHARTS_PERIOD || !this.state.playing) {
        this.shown[0].events = eventsOf(this.run);
        if (this.listKinds()) this.size();
        else this.pictures();
        this.chartsAt = performance.now() + 10 * (performance.now() - now); // charts of long runs take long
      }
      this.draw();
      this.show();
      if (this.made !== this.run.made) this.lags.push(Date.now() - 1000 * this.run.made);
      this.made = this.run.made;
      if (this.lags.length > MOST_LAGS) this.lags.shift();
    });
  }

  draw() {
    super.draw();
    if (!this.held) return;
    const { view } = this.shown[0], c = /** @type {CanvasRenderingContext2D} */ (view.canvas.getContext("2d"));
    const [x, y] = view.place(this.held.x, this.held.y);
    c.strokeStyle = this.colours().ink;
    c.lineWidth = 2;
    c.setLineDash([4, 3]);
    c.beginPath();
    c.arc(x, y, Math.max(6, (this.held.kind === "robot" ? settingOf(this.run, this.held.number, "radius") : LOOK.item.half) * view.scale), 0, 7);
    c.stroke();
    c.setLineDash([]);
  }

  /** @param {WorldView} view @param {number} px @param {number} py */
  grab(view, px, py) {
    const thing = view.thingAt(px, py, this.frameOf(this.run)), [x, y] = view.pointAt(px, py);
    this.held = null;
    this.taken = thing.number >= 0 && this.atHead ? { ...thing, x, y } : null;
  }

  /** @param {WorldView} view @param {number} px @param {number} py @returns {import("./pointer.js").Hint} */
  hint(view, px, py) {
    const { kind, number } = view.thingAt(px, py, this.frameOf(this.run)), tool = element("tool").value;
    if (!this.atHead || this.state.over) return super.hint(view, px, py);
    if (tool.startsWith("add_")) return { cursor: "copy", words: `a click adds ${tool === "add_item" ? "an item" : "a robot"} here` };
    if (number < 0) return { cursor: tool ? "not-allowed" : "move", words: tool ? "no item here" : "" };
    const click = tool ? (kind === "item" ? "a click takes it away" : "") : kind === "robot" ? `a click chooses robot ${number}${this.heldBy(view.run, number)}` : "";
    return { cursor: "grab", words: [click, `dragging moves ${kind === "robot" ? "the robot" : "the item"}`].filter(Boolean).join(", ") };
  }

  /** @param {WorldView} view @param {number} px @param {number} py */
  drag(view, px, py) {
    if (!this.taken) return false;
    const [x, y] = view.pointAt(px, py);
    this.held = { ...this.taken, x, y };
    this.draw();
    return true;
  }

  /** @param {WorldView} view @param {number} px @param {number} py */
  drop(view, px, py) {
    if (!this.taken) return;
    const [x, y] = view.pointAt(px, py), { kind, number } = this.taken;
    this.taken = null;
    this.order({ do: `put_${kind}`, [kind]: number, x, y });
  }

  /** @param {number} k @param {WorldView} view @param {number} px @param {number} py */
  click(k, view, px, py) {
    const tool = element("tool").value, [x, y] = view.pointAt(px, py);
    if (tool === "add_robot" || tool === "add_item") return void this.order({ do: tool, x, y });
    if (tool === "remove_item") {
      const { kind, number } = view.thingAt(px, py, this.frameOf(this.run));
      if (kind === "item") this.order({ do: tool, item: number });
      return;
    }
    super.click(k, view, px, py);
  }
}
