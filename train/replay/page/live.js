// @ts-check
/** The page of a session that runs now: it takes frames from its server as they are made, and gives it orders. */
import { addBlock, blocksIn, bytesOf, readRecording } from "./recording.js";
import { countsOf, eventsOf } from "./course.js";
import { plain } from "./mind.js";
import { Page, SPEEDS, element } from "./page.js";
/** @typedef {import("./recording.js").Run} Run */
/** @typedef {import("./world.js").WorldView} WorldView */
/** @typedef {{playing: boolean, speed: number, over: boolean, strategy: string, loss: number}} State */
/** @typedef {{kind: "robot" | "item", number: number, x: number, y: number}} Held a robot or an item at a place [m] */

const CHARTS_PERIOD = 500; // [ms] between two pictures of the charts
const MOST_LAGS = 1000;
const GONE = "The server does not answer. The page tries again; what came until now stays.";
const OTHER = "This session is over, or another one answers there: open the address that clean-swarm play prints. What came until now stays.";

/** A page whose run grows. */
class LivePage extends Page {
  /** @param {Run} run @param {State} state @param {string[]} strategies */
  constructor(run, state, strategies) {
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
    const options = Object.values(run.head.options)[0] ?? [];
    element("option").innerHTML = ["", ...options].map((name) => `<option value="${plain(name)}">${plain(name || "as the strategy chooses")}</option>`).join("");
    element("strategy").innerHTML = strategies.map((name) => `<option>${plain(name)}</option>`).join("");
    element("hand").hidden = false;
  }

  get moving() {
    return this.state.playing && this.atHead;
  }

  begin() {
    super.begin();
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
    element("head").addEventListener("click", () => this.go(this.end));
    this.show();
  }

  /** Show how the session runs. */
  show() {
    element("play").textContent = this.state.over ? "Over" : this.state.playing ? "Pause" : "Play";
    element("play").disabled = element("step").disabled = this.state.over;
    element("speed").value = String(SPEEDS.indexOf(this.state.speed));
    element("strategy").value = this.state.strategy;
    element("loss").value = String(this.state.loss);
    element("loss_now").textContent = `${Math.round(100 * this.state.loss)} %`;
  }

  /** Say something to the user; nothing ends it. @param {string} words */
  say(words) {
    element("said").textContent = words;
  }

  /** Have the server do something. @param {Record<string, any>} order */
  async order(order) {
    try {
      const answer = await fetch(`/do${location.search}`, { method: "POST", body: JSON.stringify(order) });
      this.say(answer.ok ? "" : (await answer.json()).error);
      if (!answer.ok) this.held = null;
    } catch {
      this.say(GONE);
    }
    this.draw();
  }

  toggle() {
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
    element("head").setAttribute("aria-pressed", String(this.atHead));
  }

  /** Show the frames that have come, in the next picture. */
  grow() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.frames = this.run.frames;
      element("time").max = String(this.end);
      if (!this.taken) this.held = null; // what was dropped is in the world
      if (this.atHead) this.time = this.end;
      const now = performance.now();
      if (now - this.chartsAt > CHARTS_PERIOD || !this.state.playing) {
        this.shown[0].events = eventsOf(this.run);
        this.shown[0].counts = countsOf(this.run, this.shown[0].events);
        this.pictures();
        this.chartsAt = performance.now() + 10 * (performance.now() - now); // charts of long runs take long
      }
      this.draw();
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
    c.arc(x, y, Math.max(6, (this.held.kind === "robot" ? this.run.head.mission.robots.radius : 0.15) * view.scale), 0, 7);
    c.stroke();
    c.setLineDash([]);
  }

  /** @param {WorldView} view @param {number} px @param {number} py */
  grab(view, px, py) {
    const thing = view.thingAt(px, py, this.frameOf(this.run)), [x, y] = view.pointAt(px, py);
    this.held = null;
    this.taken = thing.number >= 0 && this.atHead ? { ...thing, x, y } : null;
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

/** Follow the session of the server; return its page when the first frame has come. @param {{strategies: string[]}} facts @returns {Promise<LivePage>} */
export function follow({ strategies }) {
  const source = new EventSource(`/events${location.search}`);
  /** @type {Run | null} */
  let run = null;
  /** @type {LivePage | null} */
  let page = null;
  /** @type {State} */
  let state = { playing: false, speed: 1, over: false, strategy: "", loss: 0 };
  /** Blocks that have come and are not in the run yet. @type {Uint8Array[]} */
  let come = [];
  /** @param {string} words */
  const say = (words) => (page ? page.say(words) : void (element("panel").textContent = words || "Waiting for the first step: press Play."));
  source.addEventListener("open", () => say(""));
  source.addEventListener("error", () => say(source.readyState === EventSource.CLOSED ? OTHER : GONE));
  return new Promise((ready, failed) => {
    source.addEventListener("state", (event) => {
      state = JSON.parse(event.data);
      if (page) page.state = state;
      if (page) page.show();
    });
    const take = async () => {
      while (come.length) {
        if (!run) { run = await readRecording(come[0]); come.shift(); continue; }
        const now = come.slice();
        for (const blocks of await Promise.all(now.map(blocksIn))) for (const [kind, content] of blocks) addBlock(run, kind, content);
        come = come.slice(now.length);
        if (!page) { page = new LivePage(run, state, strategies); ready(page); }
        else page.grow();
      }
    };
    source.addEventListener("message", (event) => {
      come.push(bytesOf(event.data));
      if (come.length === 1) take().catch(failed);
    });
  });
}
