// @ts-check
/** What lies under the robots: pheromones, zones, things and walls. */
import { placesOf, valueAt } from "./recording.js";
import { shorter } from "./course.js";
import { LOOK, faded, partsOf } from "./look.js";
/** @typedef {import("./world.js").WorldView} WorldView */
/** @typedef {import("./look.js").Colours} Colours */

export const SMALL = 4; // size of a robot or an item below which it is a square: paths of a thousand discs take too long [pixels]
const FEW = 200; // items up to which they are never smaller than that

/** Add a diamond to the path. @param {CanvasRenderingContext2D} c @param {number} x @param {number} y @param {number} size */
function diamond(c, x, y, size) {
  c.moveTo(x - size, y);
  c.lineTo(x, y - size);
  c.lineTo(x + size, y);
  c.lineTo(x, y + size);
  c.closePath();
}

/** @param {WorldView} view @param {CanvasRenderingContext2D} c @param {Colours} colours */
export function drawZones(view, c, colours) {
  for (const [name, left, bottom, right, top] of view.run.head.zones ?? []) {
    const wide = (right - left) * view.scale, high = (top - bottom) * view.scale;
    view.images((left + right) / 2, (bottom + top) / 2, Math.max(right - left, top - bottom) / 2, (x, y) => {
      c.fillStyle = faded(LOOK.zone.colour, LOOK.zone.opacity);
      c.fillRect(x - wide / 2, y - high / 2, wide, high);
      c.fillStyle = colours.ink;
      c.font = `${LOOK.letter_size}px sans-serif`;
      c.textAlign = "left";
      c.fillText(name, x - wide / 2 + 6, y + high / 2 - 6);
    });
  }
}

/** @param {WorldView} view @param {CanvasRenderingContext2D} c @param {Colours} colours */
export function drawWalls(view, c, colours) {
  c.strokeStyle = colours.ink;
  c.lineWidth = LOOK.wall_width;
  c.lineCap = "round";
  c.beginPath();
  for (const [ax, ay, bx, by] of view.run.head.walls ?? []) {
    const x = (ax + bx) / 2, y = (ay + by) / 2, s = view.scale;
    view.images(x, y, Math.hypot(bx - ax, by - ay) / 2, (px, py) => {
      c.moveTo(px + (ax - x) * s, py - (ay - y) * s);
      c.lineTo(px + (bx - x) * s, py - (by - y) * s);
    });
  }
  c.stroke();
  c.lineCap = "butt";
}

/** @param {WorldView} view @param {CanvasRenderingContext2D} c @param {number} frame */
export function drawField(view, c, frame) {
  const { field, fieldPicture, run } = view;
  if (!run.deposits.length) return;
  const step = Math.max(1, Math.round(1 / run.head.period)), moment = frame - (frame % step);
  if (field.shown !== moment || fieldPicture.width !== field.nx) {
    const reach = field.at(moment), most = Math.max(...run.deposits.map((kind) => kind.diffusion));
    fieldPicture.width = field.nx;
    fieldPicture.height = field.ny;
    const f = /** @type {CanvasRenderingContext2D} */ (fieldPicture.getContext("2d"));
    const picture = f.createImageData(field.nx, field.ny), trail = partsOf(LOOK.pheromones.colour);
    for (let cy = 0; cy < field.ny; cy++)
      for (let cx = 0; cx < field.nx; cx++) {
        const at = 4 * ((field.ny - 1 - cy) * field.nx + cx);
        picture.data.set([...trail, 255 * LOOK.pheromones.opacity * Math.min(1, Math.max(0, reach[cy * field.nx + cx] / most))], at);
      }
    f.putImageData(picture, 0, 0);
  }
  const { width, height } = run.head;
  view.images(width / 2, height / 2, Math.max(width, height), (x, y) =>
    c.drawImage(fieldPicture, x - (width / 2) * view.scale, y - (height / 2) * view.scale, width * view.scale, height * view.scale));
}

/**
 * Draw the signs of things: those with an area around them, or the others.
 * @param {WorldView} view @param {CanvasRenderingContext2D} c @param {number} frame @param {Colours} colours @param {boolean} areas
 */
export function drawSigns(view, c, frame, colours, areas) {
  for (const one of view.run.head.drawn ?? []) {
    if (one.at === "robot" || one.radius > 0 !== areas) continue;
    const sign = LOOK.signs[one.sign], places = placesOf(view.run, one, frame);
    for (const [x, y] of areas ? places : []) view.images(x, y, one.radius, (px, py) => drawArea(c, px, py, one.radius * view.scale, sign.colour));
    if (sign.letter) for (const [x, y] of places) view.images(x, y, sign.half, (px, py) => drawLettered(view, c, px, py, sign));
    else drawSmall(view, c, places, sign, colours);
  }
}

/** @param {WorldView} view @param {CanvasRenderingContext2D} c @param {number} x @param {number} y [pixels] @param {import("./look.js").Sign} sign */
function drawLettered(view, c, x, y, sign) {
  const half = Math.max(5, sign.half * view.scale);
  c.fillStyle = sign.colour;
  c.fillRect(x - half, y - half, 2 * half, 2 * half);
  c.fillStyle = "#fff";
  c.font = `${Math.round(1.5 * half)}px sans-serif`;
  c.textAlign = "center";
  c.textBaseline = "middle";
  c.fillText(sign.letter, x, y);
}

/** @param {WorldView} view @param {CanvasRenderingContext2D} c @param {[number, number, number][]} places @param {import("./look.js").Sign} sign @param {Colours} colours */
function drawSmall(view, c, places, sign, colours) {
  const whole = Math.max(view.run.head.items > FEW ? 2 : SMALL, LOOK.item.half * view.scale), size = (whole * sign.half) / LOOK.item.half;
  c.fillStyle = sign.colour;
  if (whole < SMALL) {
    for (const [mx, my] of places) {
      const [x, y] = view.place(mx, my);
      c.fillRect(Math.round(x) - 1, Math.round(y) - 1, 3, 3);
    }
    return;
  }
  c.beginPath();
  for (const [x, y] of places) view.images(x, y, 0.2, (px, py) => shape(c, sign.shape, px, py, size));
  c.strokeStyle = colours.ink;
  c.lineWidth = 1;
  c.fill();
  c.stroke();
}

/** Add a shape to the path. @param {CanvasRenderingContext2D} c @param {string} name @param {number} x @param {number} y @param {number} half */
export function shape(c, name, x, y, half) {
  if (name === "square") c.rect(x - half, y - half, 2 * half, 2 * half);
  if (name === "diamond") diamond(c, x, y, half);
  if (name === "disc") { c.moveTo(x + half, y); c.arc(x, y, half, 0, 7); }
}

/**
 * Return where a thing is at a frame and a share of the way to the next one.
 * @param {WorldView} view @param {import("./recording.js").Thing} thing @param {number} frame @param {number} share @returns {[number, number]}
 */
export function placeOf(view, { x, y, moves }, frame, share) {
  if (moves === undefined) return [x, y];
  const { run } = view, next = Math.min(frame + 1, run.frames - 1);
  const nowX = valueAt(run, "thing_x", frame, moves), nowY = valueAt(run, "thing_y", frame, moves);
  if (share <= 0) return [nowX, nowY];
  return [
    nowX + share * shorter(valueAt(run, "thing_x", next, moves) - nowX, run.head.width),
    nowY + share * shorter(valueAt(run, "thing_y", next, moves) - nowY, run.head.height),
  ];
}

/**
 * Draw what attracts or repels robots.
 * @param {WorldView} view @param {CanvasRenderingContext2D} c @param {import("./recording.js").Thing} thing @param {number} frame @param {number} share @param {Colours} colours
 */
export function drawThing(view, c, thing, frame, share, colours) {
  const { channel, attraction, radius } = thing, [x, y] = placeOf(view, thing, frame, share);
  const size = Math.max(radius, LOOK.least_area);
  view.images(x, y, size, (px, py) => {
    drawArea(c, px, py, size * view.scale, attraction < 0 ? LOOK.areas[1].colour : LOOK.areas[0].colour);
    c.fillStyle = colours.ink;
    c.font = `${LOOK.letter_size}px sans-serif`;
    c.textAlign = "center";
    c.fillText(channel, px, py + 4);
  });
}

/** Draw a disc that means something to robots. @param {CanvasRenderingContext2D} c @param {number} x @param {number} y @param {number} r @param {string} colour */
function drawArea(c, x, y, r, colour) {
  c.strokeStyle = colour;
  c.fillStyle = faded(colour, LOOK.areas[0].opacity);
  c.lineWidth = 1;
  c.beginPath();
  c.arc(x, y, r, 0, 7);
  c.fill();
  c.stroke();
}
