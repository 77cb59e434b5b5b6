/** The lobe in the plane of incidence, in polar and in Cartesian coordinates. */

import { readTheme, type Theme } from "./colours";
import { nameMaterials } from "./command";
import { drawAxes, drawCurve, drawLegend, drawLine, DASHES, writeTick, type Box, type Curve } from "./axes";
import { askedPhi, COLUMNS, DECADES, findGreatest, loadLobe, readLobe, ROWS, scaleRadius, snapTheta, type Lobe } from "./lobe";
import { bindSelect, type Frame, type Panel, type View } from "./panel";
import type { State } from "./state";

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

function drawPolarGrid(context: CanvasRenderingContext2D, [cx, cy]: [number, number], radius: number, theme: Theme): void {
  context.strokeStyle = theme.faint;
  context.fillStyle = theme.ink;
  context.lineWidth = 0.5;
  context.font = "12px system-ui, sans-serif";
  context.textAlign = "center";
  for (const fraction of [0.25, 0.5, 0.75, 1]) {
    context.beginPath();
    context.arc(cx, cy, radius * fraction, Math.PI, 2 * Math.PI);
    context.stroke();
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
  depends: ["materials", "theta", "phi", "value", "scale"],
  prepare: addChoices,
  async draw(frame, view) {
    const theme = readTheme();
    const theta = snapTheta(view);
    const { curves, greatest } = await loadCurves(view, theta, theme);
    const [width, height] = frame.begin();
    const { context } = frame;
    const radius = Math.min(width / 2 - 34, height - 60);
    const centre: [number, number] = [width / 2, height - 22];
    drawPolarGrid(context, centre, radius, theme);
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
    return `${nameValue(view.state)} by the angle of wi; the rim is ${writeTick(Number(greatest.toPrecision(3)))} sr⁻¹${rim}. wo is on the left at ${theta}°.`;
  },
  command({ state, materials }) {
    const scale = state.scale === "linear" ? "linear" : "root";
    return `merlkit plot ${nameMaterials(materials)} --kind lobe-polar --theta ${state.theta} --value ${state.value} --scale ${scale}`;
  },
};

export const cartesianPanel: Panel = {
  id: "cartesian",
  title: "Plane of incidence, Cartesian",
  aspect: 0.66,
  depends: ["materials", "theta", "phi", "value", "scale"],
  prepare: addChoices,
  async draw(frame, view) {
    const theme = readTheme();
    const theta = snapTheta(view);
    const { curves, greatest } = await loadCurves(view, theta, theme);
    const [width, height] = frame.begin();
    const box: Box = { left: 52, top: 26, width: width - 66, height: height - 68 };
    const isLog = view.state.scale === "log";
    const x = { label: "angle of wi, degrees (wo is on the left)", min: -90, max: 90 };
    const top = greatest > 0 ? greatest * (isLog ? 1.5 : 1.05) : 1;
    const y = { label: nameValue(view.state), min: isLog ? top / 1e5 : 0, max: top, isLog };
    const place = drawAxes(frame.context, box, x, y, theme);
    frame.context.strokeStyle = theme.ink;
    frame.context.setLineDash([4, 4]);
    for (const angle of [-theta, theta]) drawLine(frame.context, place(angle, y.min), place(angle, y.max));
    for (const curve of curves) drawCurve(frame.context, curve, place, box);
    drawLegend(frame.context, curves, box, theme);
    return `Dashed: wo at −${theta}° and its mirror direction at ${theta}°.`;
  },
  command({ state, materials }) {
    const { theta, value, scale } = state;
    return `merlkit plot ${nameMaterials(materials)} --kind lobe --theta ${theta} --value ${value} --scale ${scale}`;
  },
};
