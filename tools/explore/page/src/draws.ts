/** Draws of two samplers as points that accumulate, and how far the albedo that they estimate is from the truth. */

import { askBinary, askJson, makeKey, type Entry, type Source } from "./data";
import { readTheme } from "./colours";
import { nameMaterials, quoteWord } from "./command";
import { drawAxes, drawCurve, drawLegend, DASHES, measureLegend, type Box, type Curve } from "./axes";
import { askedPhi, snapTheta } from "./lobe";
import { addButton, bindSelect, type Frame, type Panel, type View } from "./panel";

/** Draws of a request, and requests of one picture. */
const BATCH = 1024;
const MOST_BATCHES = 64;

export interface Draws {
  wi: Float32Array;
  pdf: Float32Array;
  weight: Float32Array;
}

/** Where a unit disc lies on a canvas, and how far what is drawn on it is turned, degrees. */
export interface Disc {
  centre: [number, number];
  radius: number;
  turn: number;
}

export function keyDraws(view: View, entry: Entry, sampler: string, batch: number): string {
  const { state, catalogue } = view;
  return makeKey("draws", [
    ["material", entry.id],
    ["sampler", sampler],
    ["theta", snapTheta(view)],
    ["phi", askedPhi(entry, state)],
    ["count", catalogue.stored?.count ?? BATCH],
    ["seed", (catalogue.stored?.seed ?? 1) + batch],
  ]);
}

export async function loadDraws(source: Source, key: string): Promise<Draws> {
  const { arrays } = await askBinary(source, key);
  return { wi: arrays.wi as Float32Array, pdf: arrays.pdf as Float32Array, weight: arrays.weight as Float32Array };
}

/** Draws that gave a direction. */
export function countDraws({ pdf }: Draws): number {
  return pdf.reduce((count, density) => count + (density > 0 ? 1 : 0), 0);
}

/** One pixel of the screen a draw. */
export function drawDots(frame: Frame, { centre, radius, turn }: Disc, { wi, pdf }: Draws, colour: string): void {
  const { context, canvas } = frame;
  const scale = canvas.width / frame.size()[0];
  const side = Math.max(1, Math.round(scale));
  const [cos, sin] = [Math.cos((turn * Math.PI) / 180), Math.sin((turn * Math.PI) / 180)];
  context.save();
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.fillStyle = colour;
  for (let i = 0; i < pdf.length; i++) {
    if (!(pdf[i] > 0)) continue;
    const x = cos * wi[3 * i] - sin * wi[3 * i + 1];
    const y = sin * wi[3 * i] + cos * wi[3 * i + 1];
    context.fillRect(Math.floor(scale * (centre[0] + radius * x)), Math.floor(scale * (centre[1] - radius * y)), side, side);
  }
  context.restore();
}

function drawRim(frame: Frame, { centre, radius }: Disc, label: string): void {
  const { context } = frame;
  const theme = readTheme();
  context.strokeStyle = theme.faint;
  context.lineWidth = 1;
  for (const angle of [30, 60, 90]) {
    context.beginPath();
    context.arc(...centre, radius * Math.sin((angle * Math.PI) / 180), 0, 2 * Math.PI);
    context.stroke();
  }
  context.fillStyle = theme.ink;
  context.font = "12px system-ui, sans-serif";
  context.textAlign = "center";
  context.fillText(label, centre[0], centre[1] - radius - 6);
}

/** A sampler's running estimate: sums of weights after each batch. */
interface Estimate {
  sampler: string;
  count: number;
  sum: number;
  squares: number;
  failed: number;
  errors: [number, number][];
}

function addBatch(estimate: Estimate, { pdf, weight }: Draws, truth: number): void {
  for (let i = 0; i < pdf.length; i++) {
    const mean = (weight[3 * i] + weight[3 * i + 1] + weight[3 * i + 2]) / 3;
    estimate.sum += mean;
    estimate.squares += mean * mean;
    if (!(pdf[i] > 0)) estimate.failed += 1;
  }
  estimate.count += pdf.length;
  estimate.errors.push([estimate.count, Math.abs(estimate.sum / estimate.count - truth) / truth]);
}

/** Relative standard deviation of one weight. */
function measureSpread({ count, sum, squares }: Estimate): number {
  const mean = sum / count;
  return Math.sqrt(Math.max(squares / count - mean * mean, 0)) / mean;
}

/** Number of the latest picture: batches of earlier ones are dropped. */
let latest = 0;

function layOut(width: number, height: number): { discs: [Disc, Disc]; chart: Box } {
  const radius = Math.min(width / 4 - 10, 0.3 * height);
  const down = radius + 26;
  const discs = [0.25, 0.75].map((x): Disc => ({ centre: [width * x, down], radius, turn: 0 }));
  const top = down + radius + 34;
  return { discs: [discs[0], discs[1]], chart: { left: 56, top, width: width - 72, height: height - top - 44 } };
}

/** `floor` is the relative error of the truth: what is below it is as good as exact. */
function drawErrors(frame: Frame, chart: Box, estimates: Estimate[], floor: number): void {
  const theme = readTheme();
  const curves: Curve[] = estimates.map(({ sampler, errors }, i) => ({
    name: sampler,
    colour: theme.series[i],
    dashes: DASHES[i],
    points: errors.map(([count, error]) => [count, Math.max(error, 1e-7)]),
  }));
  const all = curves.flatMap((curve) => curve.points);
  const [low, high] = [Math.min(...all.map((p) => p[1])), Math.max(...all.map((p) => p[1]))];
  const most = Math.max(...all.map((p) => p[0]));
  const x = { label: "draws", min: BATCH / 2, max: Math.max(2 * most, 8 * BATCH), isLog: true };
  // The greatest error is below the legend, which has a row more than there are samplers.
  const min = 10 ** Math.floor(Math.log10(low));
  const below = Math.max(1 - measureLegend(curves.length + 1) / chart.height, 0.5);
  const max = Math.max(min * (high / min) ** (1 / below), 10 * min);
  const y = { label: "relative error of the albedo", min, max, isLog: true };
  frame.context.fillStyle = theme.paper;
  frame.context.fillRect(0, chart.top - 26, frame.size()[0], frame.size()[1] - chart.top + 26);
  const place = drawAxes(frame.context, chart, x, y, theme);
  for (const curve of curves) {
    drawCurve(frame.context, curve, place, chart);
    frame.context.fillStyle = curve.colour;
    for (const [count, error] of curve.points) {
      const [across, down] = place(count, error);
      frame.context.fillRect(across - 2, down - 2, 4, 4);
    }
  }
  if (floor > y.min && floor < y.max) {
    const line: Curve = { name: "error of the quadrature", colour: theme.soft, dashes: [2, 4], points: [[x.min, floor], [x.max, floor]] };
    drawCurve(frame.context, line, place, chart);
    curves.push(line);
  }
  drawLegend(frame.context, curves, chart, theme);
}

function describeEstimates(estimates: Estimate[], truth: { rgb: number[]; error: number }, theta: number): string {
  const parts = estimates.map((estimate) => {
    const error = estimate.errors[estimate.errors.length - 1][1];
    const failed = estimate.failed ? `, ${estimate.failed} failed` : "";
    return `${estimate.sampler}: error ${(100 * error).toPrecision(2)} % after ${estimate.count} draws, relative standard deviation of a weight ${measureSpread(estimate).toPrecision(2)}${failed}`;
  });
  const mean = (truth.rgb[0] + truth.rgb[1] + truth.rgb[2]) / 3;
  return `Albedo at ${theta}° by quadrature ${mean.toPrecision(4)} (± ${truth.error.toPrecision(1)}). ${parts.join(". ")}. Draws of a batch are spread together.`;
}

/** What an exported page holds instead of a sampler that it does not hold. */
function snapSampler({ catalogue }: View, sampler: string, i: number): string {
  const held = catalogue.stored?.samplers;
  return !held || held.includes(sampler) ? sampler : held[Math.min(i, held.length - 1)];
}

async function accumulate(frame: Frame, view: View): Promise<string> {
  latest += 1;
  const number = latest;
  const { state, materials, source } = view;
  const [entry] = materials;
  const theta = snapTheta(view);
  const truth = await askJson<{ rgb: number[]; error: number }>(
    source,
    makeKey("albedo", [["material", entry.id], ["theta", theta], ["phi", askedPhi(entry, state)]]),
  );
  const mean = (truth.rgb[0] + truth.rgb[1] + truth.rgb[2]) / 3;
  const samplers = [state.sampler, state.rival].map((sampler, i) => snapSampler(view, sampler, i));
  const estimates = samplers.map((sampler): Estimate => ({ sampler, count: 0, sum: 0, squares: 0, failed: 0, errors: [] }));
  let caption = "";
  for (let batch = 0; batch < state.batches; batch++) {
    const keys = samplers.map((sampler) => keyDraws(view, entry, sampler, batch));
    if (batch > 0 && !keys.every((key) => source.holds(key))) break;
    const drawn = await Promise.all(keys.map((key) => loadDraws(source, key)));
    if (number !== latest) return caption;
    const theme = readTheme();
    const { discs, chart } = batch === 0 ? layOut(...frame.begin()) : layOut(...frame.size());
    drawn.forEach((draws, i) => {
      discs[i].turn = entry.isotropic ? state.phi : 0;
      if (batch === 0) drawRim(frame, discs[i], samplers[i]);
      drawDots(frame, discs[i], draws, theme.series[i]);
      addBatch(estimates[i], draws, mean);
    });
    drawErrors(frame, chart, estimates, truth.error / mean);
    caption = describeEstimates(estimates, truth, theta);
  }
  frame.canvas.dataset.count = String(estimates[0].count);
  return caption;
}

export const drawsPanel: Panel = {
  id: "draws",
  title: "Draws",
  aspect: 1.15,
  depends: ["materials", "theta", "phi", "sampler", "rival", "batches"],
  prepare(frame, view) {
    const texts = view().catalogue.stored?.samplers ?? view().catalogue.samplers.map((sampler) => sampler.text);
    bindSelect(frame, view, "sampler", "sampler", texts);
    bindSelect(frame, view, "beside", "rival", texts);
    if (view().source.isStored) return;
    addButton(frame.controls, "More draws", `Twice as many draws of each sampler, up to ${MOST_BATCHES * BATCH}`, () => {
      view().change({ batches: Math.min(2 * view().state.batches, MOST_BATCHES) });
    });
  },
  draw: accumulate,
  command(view) {
    const { state, materials } = view;
    const sampler = quoteWord(state.sampler);
    return `merlkit sample ${nameMaterials(materials.slice(0, 1))} --sampler ${sampler} --theta ${state.theta} --phi ${state.phi} --count ${state.batches * BATCH} --seed 1`;
  },
};
