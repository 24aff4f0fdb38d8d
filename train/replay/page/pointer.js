// @ts-check
/** What is done on a world with mouse and fingers: click, drag, wheel, two fingers; and what the pointer would do. */
/** @typedef {import("./world.js").WorldView} WorldView */
/** @typedef {{cursor: string, words: string}} Hint what a press would do, as the form of the pointer and in words */
/**
 * Places are [shares of the size of the canvas]; drag: returns whether anything is dragged.
 * @typedef {{grab: (view: WorldView, px: number, py: number) => void, drag: (view: WorldView, px: number, py: number) => boolean,
 *   drop: (view: WorldView, px: number, py: number) => void, click: (k: number, view: WorldView, px: number, py: number) => void,
 *   hint: (view: WorldView, px: number, py: number) => Hint, moveBy: (view: WorldView, dx: number, dy: number) => void,
 *   zoomBy: (view: WorldView, factor: number) => void}} Hands
 */

export const STEADY = 6; // [pixels] up to which a press that moves is a click

/** Show what the pointer would do, beside it; nothing without words. @param {HTMLElement} box @param {PointerEvent} e @param {string} words */
function showHint(box, e, words) {
  box.hidden = !words;
  box.textContent = words;
  box.style.left = `${Math.min(e.clientX + 14, innerWidth - 10 - box.offsetWidth)}px`;
  box.style.top = `${Math.min(e.clientY + 16, innerHeight - 30)}px`;
}

/** Give `hands` what is done on the canvas of run k. @param {HTMLCanvasElement} canvas @param {WorldView} view @param {number} k @param {Hands} hands @param {HTMLElement} box for hints */
export function listenTo(canvas, view, k, hands, box) {
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
    const frame = canvas.getBoundingClientRect();
    return [(e.clientX - frame.left) / frame.width, (e.clientY - frame.top) / frame.height];
  };
  canvas.addEventListener("pointerdown", (e) => {
    down.set(e.pointerId, [e.clientX, e.clientY]);
    canvas.setPointerCapture(e.pointerId);
    drag = down.size > 1 ? null : { x: e.clientX, y: e.clientY, moved: false };
    box.hidden = true;
    if (drag) hands.grab(view, ...shares(e));
  });
  canvas.addEventListener("pointermove", (e) => {
    if (!down.size && e.pointerType === "mouse") {
      const { cursor, words } = hands.hint(view, ...shares(e));
      canvas.style.cursor = cursor;
      showHint(box, e, words);
    }
    if (down.size > 1) {
      const before = apart();
      down.set(e.pointerId, [e.clientX, e.clientY]);
      hands.zoomBy(view, apart() / before);
      return;
    }
    if (!drag || (!drag.moved && Math.hypot(e.clientX - drag.x, e.clientY - drag.y) < STEADY)) return;
    if (hands.drag(view, ...shares(e))) { drag.moved = true; return; }
    const metre = view.scale * (canvas.getBoundingClientRect().width / view.wide);
    hands.moveBy(view, (e.clientX - drag.x) / metre, (e.clientY - drag.y) / metre);
    drag = { x: e.clientX, y: e.clientY, moved: true };
  });
  canvas.addEventListener("pointerup", (e) => {
    if (drag && !drag.moved) hands.click(k, view, ...shares(e));
    else if (drag) hands.drop(view, ...shares(e));
  });
  canvas.addEventListener("pointerleave", () => { box.hidden = true; });
  canvas.addEventListener("lostpointercapture", (e) => { // after every end of a press, also one that is cancelled
    down.delete(e.pointerId);
    drag = null;
  });
  canvas.addEventListener("wheel", (e) => {
    e.preventDefault();
    hands.zoomBy(view, e.deltaY < 0 ? 1.2 : 1 / 1.2);
  }, { passive: false });
}
