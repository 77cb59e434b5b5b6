/** The half-vector table about wo: its rows over theta_h and its nodes over the azimuth, from the words of the run-time file. */

import { makeKey } from "./data";
import { readTheme, viridis } from "./colours";
import { nameMaterials } from "./command";
import { drawAxes } from "./axes";
import { type Panel, type View } from "./panel";
import { cutSampler } from "./table";
import { snapTheta } from "./lobe";

/** Rows of a table about one wo, mixed from the two tables that enclose it. */
export interface Rows {
  /** theta_h of the rows' edges, degrees. */
  edges: number[];
  /** Probability of each row. */
  probabilities: number[];
  /** Density over the azimuth by [row, node], whose mean over a row is about 1. */
  nodes: number[][];
  isFolded: boolean;
}

/** docs/export.md describes the file, docs/half-vector-table.md the steps. */
export function readRows(words: Uint32Array, theta: number): Rows {
  const floats = new Float32Array(words.buffer, words.byteOffset, words.length);
  const halves = new Uint16Array(words.buffer, words.byteOffset, 2 * words.length);
  const [tables, rows, segments] = [words[5], words[6], words[7]];
  const fixed = 32 + tables;
  const weights = fixed + rows + 1;
  const cdf = weights + rows + 1;
  const density = cdf + Math.ceil((tables * rows) / 2) + Math.ceil((tables * rows) / 4);

  // Steps 1 and 2: the cap of the largest theta_h that reflects above the horizon.
  const [sine, cosine] = [Math.sin((theta * Math.PI) / 180), Math.cos((theta * Math.PI) / 180)];
  const top = 0.5 * (1 - cosine / Math.sqrt(2 * (1 + sine)));

  // Steps 3 and 4: the tables on both sides of wo, whose cosines fall.
  let second = 0;
  while (second < tables - 1 && floats[32 + second] > cosine) second++;
  const first = Math.max(second - 1, 0);
  const [above, below] = [floats[32 + first], floats[32 + second]];
  const weight = above > below ? Math.min(Math.max((above - cosine) / (above - below), 0), 1) : 0;
  function mix(start: number, a: number, b: number): number {
    return halves[2 * start + a] * (1 - weight) + halves[2 * start + b] * weight;
  }

  const edges: number[] = [];
  for (let edge = 0; edge <= rows; edge++) {
    // cap = sin²(theta_h/2).
    const cap = Math.min(Math.max(floats[fixed + edge] + floats[weights + edge] * top, 0), 1);
    edges.push((2 * Math.asin(Math.sqrt(cap)) * 180) / Math.PI);
  }
  const probabilities: number[] = [];
  const nodes: number[][] = [];
  let before = 0;
  for (let row = 0; row < rows; row++) {
    const to = mix(cdf, first * rows + row, second * rows + row) / 65535;
    probabilities.push(to - before);
    before = to;
    const run: number[] = [];
    for (let node = 0; node <= segments; node++) {
      const at = row * (segments + 1) + node;
      const table = rows * (segments + 1);
      run.push((mix(density, first * table + at, second * table + at) * 2 * segments) / 65534);
    }
    nodes.push(run);
  }
  return { edges, probabilities, nodes, isFolded: words[8] === 1 };
}

const held = new Map<string, Uint32Array>();

async function loadWords({ source, materials }: View): Promise<Uint32Array> {
  const [entry] = materials;
  const key = makeKey("runtime", [["material", entry.id]]);
  let words = held.get(key);
  if (!words) {
    words = cutSampler(await source.bytes(key));
    held.set(key, words);
  }
  return words;
}

export const rowsPanel: Panel = {
  id: "rows",
  title: "Half-vector table",
  aspect: 0.75,
  depends: ["materials", "theta"],
  async draw(frame, view) {
    if (!view.materials[0].table) return "The half-vector table is shown for MERL tables only.";
    const theta = snapTheta(view);
    const rows = readRows(await loadWords(view), theta);
    const [width, height] = frame.begin();
    const theme = readTheme();
    const box = { left: 52, top: 26, width: width - 66, height: height - 68 };
    const last = rows.edges[rows.edges.length - 1];
    const x = { label: "azimuth of the half vector, fraction of the widest", min: rows.isFolded ? 0 : -1, max: 1 };
    const y = { label: "theta_h, degrees; axis by its square root", min: 0, max: last };
    // Density over the cap and the azimuth: what a draw is in proportion to.
    const densities = rows.nodes.map((run, row) => {
      const width = capOf(rows.edges[row + 1]) - capOf(rows.edges[row]);
      return run.map((node) => Math.log10((rows.probabilities[row] * node) / width));
    });
    const greatest = Math.max(...densities.flat());
    densities.forEach((run, row) => {
      const [high, low] = [rows.edges[row + 1], rows.edges[row]].map((edge) => box.top + box.height * (1 - Math.sqrt(edge / last)));
      for (let segment = 0; segment + 1 < run.length; segment++) {
        const across = box.width / (run.length - 1);
        const gradient = frame.context.createLinearGradient(box.left + segment * across, 0, box.left + (segment + 1) * across, 0);
        gradient.addColorStop(0, `rgb(${viridis(1 + (run[segment] - greatest) / 5).join(",")})`);
        gradient.addColorStop(1, `rgb(${viridis(1 + (run[segment + 1] - greatest) / 5).join(",")})`);
        frame.context.fillStyle = gradient;
        frame.context.fillRect(box.left + segment * across, high, across + 0.5, low - high);
      }
      frame.context.fillStyle = theme.paper;
      frame.context.fillRect(box.left, high, box.width, 0.5);
    });
    drawAxes(frame.context, box, x, { ...y, isRoot: true }, theme);
    const likeliest = rows.probabilities.indexOf(Math.max(...rows.probabilities));
    const [low, high] = [rows.edges[likeliest], rows.edges[likeliest + 1]].map((edge) => edge.toPrecision(3));
    return `${rows.probabilities.length} rows by ${rows.nodes[0].length} nodes of ${view.materials[0].name} (half-vector:64KB) about wo at ${theta}°, by density, 5 decades. The likeliest row, ${low}° to ${high}°, holds ${(100 * rows.probabilities[likeliest]).toFixed(1)} % of the draws.`;
  },
  command({ state, materials }) {
    return `merlkit plot ${nameMaterials(materials.slice(0, 1))} --kind lobe --theta ${state.theta} --sampler half-vector:64KB`;
  },
};

function capOf(theta: number): number {
  return Math.sin((theta * Math.PI) / 360) ** 2;
}
