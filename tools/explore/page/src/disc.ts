/** The adaptive disc: the leaves of its quadtree about wo, and directions that it draws, on the unit disc of wi. */

import { askBinary, makeKey, type Answer } from "./data";
import { readTheme, viridis } from "./colours";
import { nameMaterials } from "./command";
import { countDraws, drawDots, keyDraws, loadDraws, type Disc } from "./draws";
import { snapTheta } from "./lobe";
import { bindSelect, bindSlider, type Frame, type Panel, type View } from "./panel";
import { findNearest } from "./state";

function snapNMax({ state, catalogue }: View): number {
  return catalogue.stored ? findNearest(catalogue.stored.n_max, state.nMax) : state.nMax;
}

/** Leaves coloured by the logarithm of probability over area. */
function drawLeaves(frame: Frame, { centre, radius, turn }: Disc, { arrays }: Answer): number {
  const { context } = frame;
  const { rectangles, probabilities } = arrays;
  const densities: number[] = [];
  for (let leaf = 0; leaf < probabilities.length; leaf++) {
    const [x0, y0, x1, y1] = rectangles.subarray(4 * leaf, 4 * leaf + 4);
    densities.push(Math.log10(probabilities[leaf] / ((x1 - x0) * (y1 - y0))));
  }
  const greatest = Math.max(...densities.filter(Number.isFinite));
  let leaves = 0;
  context.save();
  context.translate(...centre);
  context.scale(radius, -radius);
  context.rotate((turn * Math.PI) / 180);
  context.beginPath();
  context.arc(0, 0, 1, 0, 2 * Math.PI);
  context.clip();
  context.lineWidth = 0.6 / radius;
  context.strokeStyle = readTheme().paper;
  densities.forEach((density, leaf) => {
    if (!Number.isFinite(density)) return;
    leaves += 1;
    const [x0, y0, x1, y1] = rectangles.subarray(4 * leaf, 4 * leaf + 4);
    context.fillStyle = `rgb(${viridis(1 + (density - greatest) / 4).join(",")})`;
    context.fillRect(x0, y0, x1 - x0, y1 - y0);
    context.strokeRect(x0, y0, x1 - x0, y1 - y0);
  });
  context.restore();
  return leaves;
}

/** The sampler of a quadtree with this n_max. */
function nameSampler(nMax: number): string {
  return nMax === 2 ? "adaptive-disc" : `adaptive-disc:n-max=${nMax}`;
}

export const discPanel: Panel = {
  id: "disc",
  title: "Adaptive disc",
  aspect: 1,
  depends: ["materials", "theta", "phi", "nMax", "over"],
  prepare(frame, view) {
    bindSlider(frame, view, "n_max", "nMax", { min: 1.1, max: 16, step: 0.1, unit: "" });
    bindSelect(frame, view, "over it", "over", ["draws", "nothing"]);
  },
  async draw(frame, view) {
    const { state, materials, source } = view;
    const [entry] = materials;
    const theta = snapTheta(view);
    const nMax = snapNMax(view);
    const answer = await askBinary(source, makeKey("disc", [["material", entry.id], ["theta", theta], ["n_max", nMax]]));
    const key = keyDraws(view, entry, nameSampler(nMax), 0);
    const draws = state.over === "draws" && source.holds(key) ? await loadDraws(source, key) : null;
    const [width, height] = frame.begin();
    const disc: Disc = { centre: [width / 2, height / 2], radius: Math.min(width, height) / 2 - 10, turn: entry.isotropic ? state.phi : 0 };
    const leaves = drawLeaves(frame, disc, answer);
    if (draws) drawDots(frame, disc, draws, readTheme().ink);
    const { bytes, trials } = answer.members as { bytes: number; trials: number };
    const dots = draws ? ` ${countDraws(draws)} draws of ${nameSampler(nMax)}.` : "";
    return `${leaves} leaves of ${entry.name} about wo at ${theta}° for n_max ${nMax}, coloured by probability over area, 4 decades. ${(bytes / 1000).toFixed(0)} KB for all angles, ${trials.toFixed(2)} trials a draw.${dots}`;
  },
  command({ state, materials }) {
    const { theta, nMax } = state;
    return `merlkit plot ${nameMaterials(materials.slice(0, 1))} --kind disc --theta ${theta} --sampler ${nameSampler(nMax)} --samples 1024`;
  },
};
