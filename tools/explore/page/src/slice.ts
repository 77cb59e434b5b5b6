/** The image slice of the table, theta_d upwards and theta_h to the right, in the material's colours or as the ratio of two. */

import { diverging, encodeSrgb, readTheme } from "./colours";
import { askBinary, makeKey, type Entry } from "./data";
import { nameMaterials } from "./command";
import { drawAxes, type Box } from "./axes";
import { bindSelect, bindSlider, type Frame, type Panel, type View } from "./panel";
import { findNearest } from "./state";
import { loadTable, readCell, THETA_BINS, type Table } from "./table";

/** Stops at which the colours of a ratio end. */
const STOPS = 3;

/** Puts red, green and blue at bins of theta_h and theta_d into `out`; false where there is no value. */
type ReadSlice = (h: number, d: number, out: number[]) => boolean;

interface Slice {
  read: ReadSlice;
  /** What a reader has to know of it. */
  note: string;
}

/** The slice of a table's cells, or of values that the server computes where there is no table. */
async function loadSlice(view: View, entry: Entry): Promise<Slice> {
  const { source, state, catalogue } = view;
  if (entry.isotropic) {
    const table = await loadTable(source, entry);
    const note = table.resampled ? ` The table of ${entry.name} was resampled at the centres of MERL's bins.` : "";
    return { read: (h, d, out) => readCell(table, findCell(table, h, d, state.phiD), out), note };
  }
  const phiH = catalogue.stored ? findNearest(catalogue.stored.phi_h, state.phiH) : state.phiH;
  const phiD = catalogue.stored ? findNearest(catalogue.stored.phi_d, state.phiD) : state.phiD;
  const { arrays } = await askBinary(source, makeKey("slice", [["material", entry.id], ["phi_h", phiH], ["phi_d", phiD]]));
  function read(h: number, d: number, out: number[]): boolean {
    const at = 3 * (h * THETA_BINS + d);
    for (let channel = 0; channel < 3; channel++) out[channel] = arrays.f[at + channel];
    return out[0] >= 0;
  }
  return { read, note: ` ${entry.name} is anisotropic: values at the centres of MERL's bins, for φh ${phiH}° and φd ${phiD}°.` };
}

/** sRGB and alpha of a slice, row 0 at the greatest theta_d. */
export function paintSlice(slices: ReadSlice[], state: View["state"]): Uint8ClampedArray<ArrayBuffer> {
  const pixels = new Uint8ClampedArray(4 * THETA_BINS * THETA_BINS);
  const [a, b] = [[0, 0, 0], [0, 0, 0]];
  const gain = 2 ** state.sliceExposure;
  const isRatio = state.slice === "difference" && slices.length > 1;
  for (let d = 0; d < THETA_BINS; d++) {
    for (let h = 0; h < THETA_BINS; h++) {
      const pixel = 4 * ((THETA_BINS - 1 - d) * THETA_BINS + h);
      const [first, second] = slices;
      if (!first(h, d, a)) continue;
      let colour = a.map((x) => encodeSrgb(gain * x));
      if (isRatio) {
        if (!second(h, d, b)) continue;
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
  depends: ["materials", "phiD", "phiH", "slice", "sliceExposure"],
  prepare(frame, view) {
    bindSelect(frame, view, "show", "slice", ["colour", "difference"]);
    bindSlider(frame, view, "phi_d", "phiD", { min: 0, max: 179, step: 1, unit: "°" });
    bindSlider(frame, view, "phi_h", "phiH", { min: 0, max: 358, step: 2, unit: "°" });
    const turn = frame.controls.lastElementChild as HTMLElement;
    function hideTurn(): void {
      turn.hidden = view().materials.every((entry) => entry.isotropic);
    }
    frame.syncs.push(hideTurn);
    hideTurn();
    bindSlider(frame, view, "exposure", "sliceExposure", { min: -8, max: 8, step: 0.25, unit: " stops" });
  },
  async draw(frame, view) {
    const { state, materials } = view;
    const shown = state.slice === "difference" ? materials.slice(0, 2) : materials.slice(0, 1);
    const slices = await Promise.all(shown.map((entry) => loadSlice(view, entry)));
    const [width, height] = frame.begin();
    const side = Math.min(width - 62, height - 66);
    const box = { left: 48, top: 24, width: side, height: side };
    frame.context.fillStyle = "#8a8a8a";
    frame.context.fillRect(box.left, box.top, side, side);
    drawImage(frame, box, paintSlice(slices.map((slice) => slice.read), state));
    const x = { label: "theta_h, bins of (theta_h/90°)^½·90", min: 0, max: 90 };
    drawAxes(frame.context, box, x, { label: "theta_d, degrees", min: 0, max: 90 }, readTheme());
    const gaps = `Grey has no values.${slices.map((slice) => slice.note).join("")}`;
    if (slices.length > 1) {
      return `Ratio of ${shown[1].name} to ${shown[0].name}: blue is darker, orange brighter, by up to ${STOPS} stops. ${gaps}`;
    }
    if (state.slice === "difference") return `Add a second material to see the difference. ${gaps}`;
    return `${shown[0].name}, tone-mapped as pictures are; an f_r of ${Number((2 ** -state.sliceExposure).toPrecision(3))} sr⁻¹ is nearly white. ${gaps}`;
  },
  command({ state, materials }) {
    // The command plots slices of tables alone.
    if (!materials[0]?.isotropic) return null;
    return `merlkit plot ${nameMaterials(materials.slice(0, 1))} --kind slice-rgb --phi-d ${state.phiD} --exposure=${state.sliceExposure} -o slice.png`;
  },
};
