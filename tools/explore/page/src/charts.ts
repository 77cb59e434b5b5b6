/** The lobe in the plane of incidence, in polar and in Cartesian coordinates. */

import { readTheme, type Theme } from "./colours";
import { nameMaterials } from "./command";
import { cutAxis, drawAxes, drawCurve, drawLegend, drawLine, DASHES, writeTick, type Box, type Curve } from "./axes";
import { askedPhi, COLUMNS, DECADES, findGreatest, loadLobe, readLobe, ROWS, scaleRadius, snapTheta, type Lobe } from "./lobe";
import { bindSelect, type Frame, type Panel, type View } from "./panel";
import type { State } from "./state";
import { onZoom, type Part } from "./zoom";

/** The lobe by the signed angle of wi, -90 (the side of wo) to 90 (the side of its mirror direction). */
export function cutLobe(lobe: Lobe, state: State): [number, number][] {
  const column = askedPhi(lobe.entry, state) / 2;
  const points: [number, number][] = [];
  for (let row = ROWS - 1; row >= 0; row--) points.push([-(row + 0.5), readLobe(lobe, row, column, state.value)]);
  for (let row = 0; row < ROWS; row++) points.push([row + 0.5, readLobe(lobe, row, column + COLUMNS / 2, state.value)]);
  return points;
}

async function loadCurves(view: View, theta: number, theme: Theme): Promise<{ curves: Curve[]; greatest: number }> {
  const { state, materials, source } = view;
  const lobes = await Promise.all(materials.map((entry) => loadLobe(source, entry, theta, state)));
  const curves = lobes.map((lobe, i) => ({
    name: lobe.entry.name,
    colour: theme.series[i],
    dashes: DASHES[i],
    points: cutLobe(lobe, state),
  }));
  // The plane's own greatest: a lobe's peak lies in it unless the material is anisotropic.
  const inPlane = curves.flatMap((curve) => curve.points.map((point) => point[1]));
  return { curves, greatest: Math.max(...inPlane, 0) || findGreatest(lobes, state.value) };
}

function nameValue(state: State): string {
  return state.value === "f" ? "f_r, 1/sr" : "f_r·cosθi, 1/sr";
}

function addChoices(frame: Frame, view: () => View): void {
  bindSelect(frame, view, "value", "value", ["f-cos", "f"]);
  bindSelect(frame, view, "scale", "scale", ["linear", "log"]);
}

/** Lets a plot be zoomed by three members of the state. */
function addZoom(frame: Frame, view: () => View, name: "polar" | "plot", box: () => Box): void {
  const [zoom, x, y] = [`${name}Zoom`, `${name}X`, `${name}Y`] as ["polarZoom", "polarX", "polarY"];
  function boxNow(): [number, number, number, number] {
    const { left, top, width, height } = box();
    return [left, top, width, height];
  }
  onZoom(
    frame.canvas,
    boxNow,
    () => readPart(view().state, name),
    (part) => view().change({ [zoom]: part.zoom, [x]: part.x, [y]: part.y }),
  );
}

/** The part of a plot that is seen; a bent link may name one that reaches outside. */
function readPart(state: State, name: "polar" | "plot"): Part {
  const part = name === "polar" ? [state.polarZoom, state.polarX, state.polarY] : [state.plotZoom, state.plotX, state.plotY];
  const most = 1 - 1 / part[0];
  return { zoom: part[0], x: Math.min(part[1], most), y: Math.min(part[2], most) };
}

function describeZoom({ zoom }: Part): string {
  return zoom > 1 ? ` Zoomed ${Number(zoom.toPrecision(2))} times; a double click shows all.` : "";
}

/** Rings at a fraction of the rim, whose values are written where they cross a line, and spokes. */
function drawPolarGrid(
  context: CanvasRenderingContext2D,
  [cx, cy]: [number, number],
  radius: number,
  theme: Theme,
  zoom: number,
  [width, height]: [number, number],
  write: (fraction: number) => string,
): void {
  context.strokeStyle = theme.faint;
  context.fillStyle = theme.ink;
  context.lineWidth = 0.5;
  context.font = "12px system-ui, sans-serif";
  context.textAlign = "center";
  // Rings halve their distance each time that the zoom doubles.
  const rings = 4 * 2 ** Math.floor(Math.log2(zoom));
  for (let ring = 1; ring <= rings; ring++) {
    const r = (radius * ring) / rings;
    context.beginPath();
    context.arc(cx, cy, r, Math.PI, 2 * Math.PI);
    context.stroke();
    // Of the whole plot the caption says what the rim is.
    const up = Math.sqrt(r * r - (width / 2 - cx) ** 2);
    if (zoom > 1 && cy - up > 0 && cy - up < height) context.fillText(write(ring / rings), width / 2, cy - up - 3);
  }
  for (let angle = -90; angle <= 90; angle += 30) {
    const a = (angle * Math.PI) / 180;
    const end: [number, number] = [cx + radius * Math.sin(a), cy - radius * Math.cos(a)];
    drawLine(context, [cx, cy], end);
    const [x, y] = [cx + (radius + 14) * Math.sin(a), cy - (radius + 8) * Math.cos(a)];
    context.fillText(`${Math.abs(angle)}°`, x, y);
  }
}

export const polarPanel: Panel = {
  id: "polar",
  title: "Plane of incidence, polar",
  aspect: 0.66,
  depends: ["materials", "theta", "phi", "value", "scale", "polarZoom", "polarX", "polarY"],
  prepare(frame, view) {
    addChoices(frame, view);
    addZoom(frame, view, "polar", () => {
      const [width, height] = frame.size();
      return { left: 0, top: 0, width, height };
    });
  },
  async draw(frame, view) {
    const theme = readTheme();
    const theta = snapTheta(view);
    const { curves, greatest } = await loadCurves(view, theta, theme);
    const [width, height] = frame.begin();
    const { context } = frame;
    const part = readPart(view.state, "polar");
    const radius = part.zoom * Math.min(width / 2 - 34, height - 60);
    const centre: [number, number] = [part.zoom * (width / 2 - part.x * width), part.zoom * (height - 22 - part.y * height)];
    function writeRing(fraction: number): string {
      const value = view.state.scale === "linear" ? fraction * greatest : greatest * 10 ** (DECADES * (fraction - 1));
      return writeTick(Number(value.toPrecision(3)));
    }
    drawPolarGrid(context, centre, radius, theme, part.zoom, [width, height], writeRing);
    function place(angle: number, value: number): [number, number] {
      const a = (angle * Math.PI) / 180;
      const r = radius * scaleRadius(value, greatest, view.state.scale);
      return [centre[0] + r * Math.sin(a), centre[1] - r * Math.cos(a)];
    }
    const box: Box = { left: 0, top: 0, width, height };
    for (const curve of curves) drawCurve(context, curve, place, box);
    context.strokeStyle = theme.ink;
    context.lineWidth = 1.5;
    const o = (-theta * Math.PI) / 180;
    drawLine(context, centre, [centre[0] + radius * Math.sin(o), centre[1] - radius * Math.cos(o)]);
    context.fillStyle = theme.ink;
    context.fillText("wo", centre[0] + 0.8 * radius * Math.sin(o) - 14, centre[1] - 0.8 * radius * Math.cos(o));
    drawLegend(context, curves, box, theme);
    const rim = view.state.scale === "linear" ? "" : `, the centre ${DECADES} decades below`;
    return `${nameValue(view.state)} by the angle of wi; the rim is ${writeTick(Number(greatest.toPrecision(3)))} sr⁻¹${rim}. wo is on the left at ${theta}°.${describeZoom(part)}`;
  },
  command({ state, materials }) {
    const scale = state.scale === "linear" ? "linear" : "root";
    return `merlkit plot ${nameMaterials(materials)} --kind lobe-polar --theta ${state.theta} --value ${state.value} --scale ${scale}`;
  },
};

function findPlotBox([width, height]: [number, number]): Box {
  return { left: 52, top: 26, width: width - 66, height: height - 68 };
}

export const cartesianPanel: Panel = {
  id: "cartesian",
  title: "Plane of incidence, Cartesian",
  aspect: 0.66,
  depends: ["materials", "theta", "phi", "value", "scale", "plotZoom", "plotX", "plotY"],
  prepare(frame, view) {
    addChoices(frame, view);
    addZoom(frame, view, "plot", () => findPlotBox(frame.size()));
  },
  async draw(frame, view) {
    const theme = readTheme();
    const theta = snapTheta(view);
    const { curves, greatest } = await loadCurves(view, theta, theme);
    const [width, height] = frame.begin();
    const box = findPlotBox([width, height]);
    const part = readPart(view.state, "plot");
    const isLog = view.state.scale === "log";
    const wholeX = { label: "angle of wi, degrees (wo is on the left)", min: -90, max: 90 };
    const top = greatest > 0 ? greatest * (isLog ? 1.5 : 1.05) : 1;
    const wholeY = { label: nameValue(view.state), min: isLog ? top / 1e5 : 0, max: top, isLog };
    const x = cutAxis(wholeX, part.x, part.x + 1 / part.zoom);
    const y = cutAxis(wholeY, 1 - part.y - 1 / part.zoom, 1 - part.y);
    const place = drawAxes(frame.context, box, x, y, theme);
    frame.context.strokeStyle = theme.ink;
    frame.context.setLineDash([4, 4]);
    for (const angle of [-theta, theta]) {
      if (angle >= x.min && angle <= x.max) drawLine(frame.context, place(angle, y.min), place(angle, y.max));
    }
    for (const curve of curves) drawCurve(frame.context, curve, place, box);
    drawLegend(frame.context, curves, box, theme);
    return `Dashed: wo at −${theta}° and its mirror direction at ${theta}°.${describeZoom(part)}`;
  },
  command({ state, materials }) {
    const { theta, value, scale } = state;
    return `merlkit plot ${nameMaterials(materials)} --kind lobe --theta ${theta} --value ${value} --scale ${scale}`;
  },
};
