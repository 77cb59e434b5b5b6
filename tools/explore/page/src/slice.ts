/** The image slice of the table, theta_d upwards and theta_h to the right, in the material's colours or as the ratio of two. */

import { diverging, encodeSrgb, readTheme } from "./colours";
import { nameMaterials } from "./command";
import { drawAxes, type Box } from "./axes";
import { bindSelect, bindSlider, type Frame, type Panel, type View } from "./panel";
import { loadTable, readCell, THETA_BINS, type Table } from "./table";

/** Stops at which the colours of a ratio end. */
const STOPS = 3;

/** sRGB and alpha of a slice, row 0 at the greatest theta_d. */
export function paintSlice(tables: Table[], state: View["state"]): Uint8ClampedArray<ArrayBuffer> {
  const pixels = new Uint8ClampedArray(4 * THETA_BINS * THETA_BINS);
  const [a, b] = [[0, 0, 0], [0, 0, 0]];
  const gain = 2 ** state.sliceExposure;
  const isRatio = state.slice === "difference" && tables.length > 1;
  for (let d = 0; d < THETA_BINS; d++) {
    for (let h = 0; h < THETA_BINS; h++) {
      const pixel = 4 * ((THETA_BINS - 1 - d) * THETA_BINS + h);
      const [first, second] = tables;
      if (!readCell(first, findCell(first, h, d, state.phiD), a)) continue;
      let colour = a.map((x) => encodeSrgb(gain * x));
      if (isRatio) {
        if (!readCell(second, findCell(second, h, d, state.phiD), b)) continue;
        colour = diverging(Math.log2(sum(b) / sum(a)) / STOPS);
      }
      pixels.set([...colour, 255], pixel);
    }
  }
  return pixels;
}

function sum(rgb: number[]): number {
  return rgb[0] + rgb[1] + rgb[2];
}

function findCell(table: Table, h: number, d: number, phiD: number): number {
  return (h * THETA_BINS + d) * table.phiBins + Math.min(Math.round(phiD), table.phiBins - 1);
}

function drawImage(frame: Frame, box: Box, pixels: Uint8ClampedArray<ArrayBuffer>): void {
  const small = document.createElement("canvas");
  small.width = small.height = THETA_BINS;
  small.getContext("2d")!.putImageData(new ImageData(pixels, THETA_BINS, THETA_BINS), 0, 0);
  frame.context.imageSmoothingEnabled = false;
  frame.context.drawImage(small, box.left, box.top, box.width, box.height);
}

export const slicePanel: Panel = {
  id: "slice",
  title: "Image slice",
  aspect: 1,
  depends: ["materials", "phiD", "slice", "sliceExposure"],
  prepare(frame, view) {
    bindSelect(frame, view, "show", "slice", ["colour", "difference"]);
    bindSlider(frame, view, "phi_d", "phiD", { min: 0, max: 179, step: 1, unit: "°" });
    bindSlider(frame, view, "exposure", "sliceExposure", { min: -8, max: 8, step: 0.25, unit: " stops" });
  },
  async draw(frame, view) {
    const { state, materials, source } = view;
    const shown = state.slice === "difference" ? materials.slice(0, 2) : materials.slice(0, 1);
    const tables = await Promise.all(shown.map((entry) => loadTable(source, entry)));
    const [width, height] = frame.begin();
    const side = Math.min(width - 62, height - 66);
    const box = { left: 48, top: 24, width: side, height: side };
    frame.context.fillStyle = "#8a8a8a";
    frame.context.fillRect(box.left, box.top, side, side);
    drawImage(frame, box, paintSlice(tables, state));
    const x = { label: "theta_h, bins of (theta_h/90°)^½·90", min: 0, max: 90 };
    drawAxes(frame.context, box, x, { label: "theta_d, degrees", min: 0, max: 90 }, readTheme());
    const gaps = "Grey has no values.";
    if (tables.length > 1) {
      return `Ratio of ${shown[1].name} to ${shown[0].name}: blue is darker, orange brighter, by up to ${STOPS} stops. ${gaps}`;
    }
    if (state.slice === "difference") return `Add a second material to see the difference. ${gaps}`;
    const resampled = tables[0].resampled ? " Its table was resampled at the centres of MERL's bins." : "";
    return `${shown[0].name}, tone-mapped as pictures are; an f_r of ${Number((2 ** -state.sliceExposure).toPrecision(3))} sr⁻¹ is nearly white. ${gaps}${resampled}`;
  },
  command({ state, materials }) {
    return `merlkit plot ${nameMaterials(materials.slice(0, 1))} --kind slice-rgb --phi-d ${state.phiD} --exposure=${state.sliceExposure} -o slice.png`;
  },
};
