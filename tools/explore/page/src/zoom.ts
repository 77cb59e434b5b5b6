/** Zooming in plots: by the wheel, by two fingers, and by the keyboard. */

/** The part of a plot that is seen: a square with the side 1/zoom of its unit square, whose upper left corner is at x, y. */
export interface Part {
  zoom: number;
  x: number;
  y: number;
}

export const MOST_ZOOM = 64;
/** A step of the keyboard, and one of the wheel in CSS pixels that doubles. */
const KEY_FACTOR = 1.25;
const WHEEL_PIXELS = 240;
/** CSS pixels of a line of the wheel. */
const LINE = 16;

/** Digits that a link keeps. */
function shorten(value: number): number {
  return Number(value.toFixed(5));
}

/** A part that lies in the unit square. */
function place(zoom: number, x: number, y: number): Part {
  const bounded = shorten(Math.min(Math.max(zoom, 1), MOST_ZOOM));
  const most = 1 - 1 / bounded;
  const [across, down] = [x, y].map((from) => shorten(Math.min(Math.max(from, 0), most)));
  return { zoom: bounded, x: across, y: down };
}

/** The part after zooming about a point of what is seen, whose coordinates are from 0 to 1. */
export function zoomAbout(part: Part, factor: number, [px, py]: [number, number]): Part {
  const zoom = Math.min(Math.max(part.zoom * factor, 1), MOST_ZOOM);
  // The point stays where it is: x + px/zoom before and after.
  const shrunk = 1 / part.zoom - 1 / zoom;
  return place(zoom, part.x + px * shrunk, part.y + py * shrunk);
}

/** The part after what is seen was moved by a fraction of itself. */
export function movePart({ zoom, x, y }: Part, dx: number, dy: number): Part {
  return place(zoom, x - dx / zoom, y - dy / zoom);
}

/** Lets a canvas be zoomed; `box` is the plot's left, top, width and height in CSS pixels. */
export function onZoom(canvas: HTMLCanvasElement, box: () => [number, number, number, number], read: () => Part, write: (part: Part) => void): void {
  const fingers = new Map<number, [number, number]>();
  canvas.tabIndex = 0;
  canvas.title = "Wheel, two fingers, + and − zoom; dragging and arrow keys move what is zoomed; a double click or 0 shows all";

  function locate(x: number, y: number): [number, number] {
    const [left, top, width, height] = box();
    const edge = canvas.getBoundingClientRect();
    return [(x - edge.left - left) / width, (y - edge.top - top) / height];
  }
  function show(part: Part): void {
    // One finger scrolls the page, unless there is something to be moved.
    canvas.style.touchAction = part.zoom > 1 ? "none" : "pan-y";
    write(part);
  }
  canvas.style.touchAction = read().zoom > 1 ? "none" : "pan-y";

  canvas.addEventListener(
    "wheel",
    (event) => {
      const part = read();
      // Where all is seen already, turning back scrolls the page.
      if (part.zoom === 1 && event.deltaY >= 0) return;
      event.preventDefault();
      const pixels = event.deltaMode === 0 ? event.deltaY : event.deltaY * LINE;
      show(zoomAbout(part, 2 ** (-pixels / WHEEL_PIXELS), locate(event.clientX, event.clientY)));
    },
    { passive: false },
  );
  canvas.addEventListener("dblclick", () => show(place(1, 0, 0)));
  canvas.addEventListener("keydown", (event) => {
    const factor = { "+": KEY_FACTOR, "=": KEY_FACTOR, "-": 1 / KEY_FACTOR, "−": 1 / KEY_FACTOR }[event.key];
    const steps: Record<string, [number, number]> = { ArrowLeft: [0.1, 0], ArrowRight: [-0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] };
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (factor) show(zoomAbout(read(), factor, [0.5, 0.5]));
    else if (event.key === "0") show(place(1, 0, 0));
    else if (steps[event.key] && read().zoom > 1) show(movePart(read(), ...steps[event.key]));
    else return;
    event.preventDefault();
  });

  canvas.addEventListener("pointerdown", (event) => {
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
    canvas.setPointerCapture(event.pointerId);
  });
  for (const name of ["pointerup", "pointercancel"] as const) {
    canvas.addEventListener(name, (event) => fingers.delete(event.pointerId));
  }
  canvas.addEventListener("pointermove", (event) => {
    if (!fingers.has(event.pointerId)) return;
    const before = [...fingers.values()];
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
    const after = [...fingers.values()];
    const [from, to] = [findMiddle(before), findMiddle(after)];
    const [, , width, height] = box();
    const moved = movePart(read(), (to[0] - from[0]) / width, (to[1] - from[1]) / height);
    const spread = [before, after].map(measureSpread);
    const factor = spread[0] > 0 && spread[1] > 0 ? spread[1] / spread[0] : 1;
    if (factor !== 1 || moved.zoom > 1) show(zoomAbout(moved, factor, locate(...to)));
  });
}

function findMiddle(points: [number, number][]): [number, number] {
  const sum = points.reduce(([x, y], point) => [x + point[0], y + point[1]], [0, 0]);
  return [sum[0] / points.length, sum[1] / points.length];
}

/** The distance of two fingers; 0 for one. */
function measureSpread([first, second]: [number, number][]): number {
  return second ? Math.hypot(second[0] - first[0], second[1] - first[1]) : 0;
}
