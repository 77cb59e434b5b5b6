/** Axes and curves on a canvas. */

import type { Theme } from "./colours";

export interface Axis {
  label: string;
  min: number;
  max: number;
  isLog?: boolean;
  /** Even steps of the square root; `min` is 0. */
  isRoot?: boolean;
}

export interface Curve {
  name: string;
  colour: string;
  dashes?: number[];
  points: [number, number][];
}

export interface Box {
  left: number;
  top: number;
  width: number;
  height: number;
}

/** Characters of a name in a legend. */
const LONGEST_NAME = 30;
const FONT = "12px system-ui, sans-serif";
export const DASHES = [[], [8, 4], [2, 3]];

/** Three to eight round numbers within the axis. */
export function makeTicks({ min, max, isLog }: Axis): number[] {
  const ticks: number[] = [];
  if (isLog) {
    const [low, high] = [Math.ceil(Math.log10(min) - 1e-9), Math.floor(Math.log10(max) + 1e-9)];
    const step = Math.max(1, Math.ceil((high - low) / 6));
    for (let power = low; power <= high; power += step) ticks.push(10 ** power);
    // Within two decades, powers of ten are too few.
    if (high - low < 2) ticks.push(...[low - 1, low, high].flatMap((power) => [2 * 10 ** power, 5 * 10 ** power]));
    const within = [...new Set(ticks)].filter((tick) => tick >= min && tick <= max);
    // Within less than a decade, round numbers with even steps are more.
    return within.length < 3 ? makeTicks({ label: "", min, max }) : within;
  }
  const rough = (max - min) / 6;
  const unit = 10 ** Math.floor(Math.log10(rough));
  const step = unit * ([1, 2, 5, 10].find((factor) => factor * unit >= rough) ?? 10);
  for (let i = Math.ceil(min / step - 1e-9); i * step <= max + 1e-9 * step; i++) ticks.push(i * step);
  return ticks;
}

export function writeTick(value: number): string {
  const size = Math.abs(value);
  if (size !== 0 && (size < 0.001 || size >= 100_000)) return value.toExponential(0).replace("e+", "e");
  return String(Number(value.toPrecision(4)));
}

/** Position of a value along an axis, 0 to 1. */
export function placeOnAxis({ min, max, isLog, isRoot }: Axis, value: number): number {
  if (isRoot) return Math.sqrt(Math.max(value, 0) / max);
  if (isLog) return (Math.log(Math.max(value, min)) - Math.log(min)) / (Math.log(max) - Math.log(min));
  return (value - min) / (max - min);
}

/** The value at a position along an axis. */
function findValue({ min, max, isLog }: Axis, position: number): number {
  return isLog ? min * (max / min) ** position : min + (max - min) * position;
}

/** The axis between two positions along it. */
export function cutAxis(axis: Axis, from: number, to: number): Axis {
  return { ...axis, min: findValue(axis, from), max: findValue(axis, to) };
}

/** A frame with ticks, grid lines and labels; returns where points of it lie. */
export function drawAxes(context: CanvasRenderingContext2D, box: Box, x: Axis, y: Axis, theme: Theme): (px: number, py: number) => [number, number] {
  function place(px: number, py: number): [number, number] {
    return [box.left + box.width * placeOnAxis(x, px), box.top + box.height * (1 - placeOnAxis(y, py))];
  }
  context.font = FONT;
  context.fillStyle = theme.ink;
  context.strokeStyle = theme.faint;
  context.lineWidth = 0.5;
  context.setLineDash([]);
  context.textAlign = "center";
  context.textBaseline = "top";
  for (const tick of makeTicks(x)) {
    const [across] = place(tick, y.min);
    drawLine(context, [across, box.top], [across, box.top + box.height]);
    context.fillText(writeTick(tick), across, box.top + box.height + 5);
  }
  context.fillText(x.label, box.left + box.width / 2, box.top + box.height + 21);
  context.textAlign = "right";
  context.textBaseline = "middle";
  for (const tick of makeTicks(y)) {
    const [, down] = place(x.min, tick);
    drawLine(context, [box.left, down], [box.left + box.width, down]);
    context.fillText(writeTick(tick), box.left - 5, down);
  }
  context.textAlign = "left";
  context.textBaseline = "bottom";
  context.fillText(y.label, Math.max(box.left - 44, 2), box.top - 8);
  context.textBaseline = "alphabetic";
  return place;
}

export function drawLine(context: CanvasRenderingContext2D, from: [number, number], to: [number, number]): void {
  context.beginPath();
  context.moveTo(...from);
  context.lineTo(...to);
  context.stroke();
}

/** A curve within a box. */
export function drawCurve(context: CanvasRenderingContext2D, curve: Curve, place: (x: number, y: number) => [number, number], box: Box): void {
  context.save();
  context.beginPath();
  context.rect(box.left, box.top, box.width, box.height);
  context.clip();
  context.strokeStyle = curve.colour;
  context.lineWidth = 2;
  context.lineJoin = "round";
  context.setLineDash(curve.dashes ?? []);
  context.beginPath();
  for (const [x, y] of curve.points) context.lineTo(...place(x, y));
  context.stroke();
  context.restore();
}

/** CSS pixels between rows of a legend, and from the top of its box to the middle of the first. */
const ROW = 17;
const FIRST_ROW = 12;

/** CSS pixels that a legend takes from the top of its box. */
export function measureLegend(rows: number): number {
  return FIRST_ROW + ROW * rows;
}

/** Names of curves with a piece of each, one under the other from the upper right corner of a box. */
export function drawLegend(context: CanvasRenderingContext2D, curves: Curve[], box: Box, theme: Theme): void {
  context.font = FONT;
  context.textAlign = "right";
  context.textBaseline = "middle";
  curves.forEach((curve, i) => {
    const down = box.top + FIRST_ROW + ROW * i;
    const right = box.left + box.width - 36;
    context.fillStyle = theme.paper;
    context.globalAlpha = 0.75;
    const name = curve.name.length > LONGEST_NAME ? `${curve.name.slice(0, LONGEST_NAME - 1)}…` : curve.name;
    const across = context.measureText(name).width;
    context.fillRect(right - across - 3, down - 8, across + 39, 16);
    context.globalAlpha = 1;
    context.fillStyle = theme.ink;
    context.fillText(name, right, down);
    context.strokeStyle = curve.colour;
    context.lineWidth = 2;
    context.setLineDash(curve.dashes ?? []);
    drawLine(context, [right + 6, down], [right + 34, down]);
  });
  context.setLineDash([]);
  context.textBaseline = "alphabetic";
}
