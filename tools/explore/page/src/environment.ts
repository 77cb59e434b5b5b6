/** The environment as a map, with directions over it that are chosen by its light, by the BRDF, or by resampling. */

import { askBinary, makeKey } from "./data";
import { encodeSrgb, readTheme } from "./colours";
import { nameMaterials } from "./command";
import { snapTheta } from "./lobe";
import { bindSelect, bindSlider, type Frame, type Panel } from "./panel";

async function drawMap(frame: Frame, radiance: Float32Array, [across, down]: [number, number], [width, height]: [number, number]): Promise<void> {
  const pixels = new Uint8ClampedArray(4 * across * down);
  for (let i = 0; i < across * down; i++) {
    for (let channel = 0; channel < 3; channel++) pixels[4 * i + channel] = encodeSrgb(radiance[3 * i + channel]);
    pixels[4 * i + 3] = 255;
  }
  const small = document.createElement("canvas");
  [small.width, small.height] = [across, down];
  small.getContext("2d")!.putImageData(new ImageData(pixels, across, down), 0, 0);
  frame.context.drawImage(small, 0, 0, width, height);
}

/** Points with a rim, so that they are seen over any radiance. */
function drawPoints(frame: Frame, uv: Float32Array, pdf: Float32Array, [width, height]: [number, number]): number {
  const { context } = frame;
  context.fillStyle = readTheme().series[1];
  context.strokeStyle = "#000000";
  context.lineWidth = 0.5;
  let count = 0;
  for (let i = 0; i < pdf.length; i++) {
    if (!(pdf[i] > 0)) continue;
    count += 1;
    context.beginPath();
    context.arc(width * uv[2 * i], height * uv[2 * i + 1], 1.8, 0, 2 * Math.PI);
    context.fill();
    context.stroke();
  }
  return count;
}

export const environmentPanel: Panel = {
  id: "environment",
  title: "Environment",
  aspect: 0.5,
  depends: ["materials", "theta", "phi", "map", "strategy", "keep", "candidates"],
  prepare(frame, view) {
    bindSelect(frame, view, "map", "map", view().catalogue.environments);
    bindSelect(frame, view, "directions by", "strategy", ["light", "brdf", "ris"]);
    bindSlider(frame, view, "kept", "keep", { min: 16, max: 4096, step: 16, unit: "" });
    bindSlider(frame, view, "candidates of ris", "candidates", { min: 1, max: 64, step: 1, unit: "" });
  },
  async draw(frame, view) {
    const { state, materials, source } = view;
    const [entry] = materials;
    const theta = snapTheta(view);
    const map = await askBinary(source, makeKey("environment", [["name", state.map]]));
    const key = makeKey("environment-draws", [
      ["name", state.map],
      ["material", entry.id],
      ["strategy", state.strategy],
      ["theta", theta],
      ["phi", source.isStored ? 0 : state.phi],
      ["keep", state.keep],
      ["candidates", state.candidates],
      ["seed", 1],
    ]);
    const draws = source.holds(key) ? await askBinary(source, key) : null;
    const size = frame.begin();
    await drawMap(frame, map.arrays.radiance as Float32Array, map.members.size as [number, number], size);
    if (!draws) return `${state.map}. This exported page holds no directions for these settings.`;
    const count = drawPoints(frame, draws.arrays.uv as Float32Array, draws.arrays.pdf as Float32Array, size);
    const ways = { light: "the map's light", brdf: `the half-vector table of ${entry.name}`, ris: `resampling one of ${state.candidates} draws of the half-vector table` };
    return `${count} directions by ${ways[state.strategy]}, for wo at ${theta}°, ${source.isStored ? 0 : state.phi}° on a surface that faces the zenith. Latitude by longitude, the zenith on top.`;
  },
  command({ state, materials }) {
    const candidates = state.strategy === "ris" ? ` --candidates ${state.candidates}` : "";
    return `merlkit render ${nameMaterials(materials.slice(0, 1))} --light ${state.map} --strategy ${state.strategy}${candidates} -o environment`;
  },
};
