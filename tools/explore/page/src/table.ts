/** A material's table: words of nine bits a channel and a common exponent, on the GPU and here. */

import { askBinary, makeKey, type Entry, type Source } from "./data";
import { makeWordTexture, type Gpu } from "./gpu";

export const THETA_BINS = 90;
/** Width of the texture of cells: nine runs of phi_d. */
export const CELLS_ACROSS = 1620;
/** Words in a row of the texture that merlkit.glsl reads. */
const WORDS_ACROSS = 2048;
/** The word of a cell without a value: the greatest exponent without a mantissa. */
export const INVALID = 0xf8000000;

export interface Table {
  words: Uint32Array;
  /** Bins of phi_d: 180, or 360 without the symmetry. */
  phiBins: number;
  /** A channel's value is m · 2^e · unit. */
  unit: number;
  /** Largest relative rounding error, as measured. */
  error: number;
  resampled: boolean;
}

export async function loadTable(source: Source, entry: Entry): Promise<Table> {
  if (!entry.isotropic) throw new Error(`${entry.name} is anisotropic: spheres and slices need a MERL table, which is isotropic.`);
  const { members, arrays } = await askBinary(source, makeKey("table", [["material", entry.id]]));
  const words = arrays.table as Uint32Array;
  const phiBins = words.length / THETA_BINS / THETA_BINS;
  if (phiBins !== 180 && phiBins !== 360) throw new Error(`the table of ${entry.name} has ${words.length} cells: page and server differ in version`);
  return { words, phiBins, unit: members.unit as number, error: members.error as number, resampled: members.resampled === true };
}

/** Red, green and blue of a cell into `out`; false for one without a value. */
export function readCell(table: Table, cell: number, out: number[]): boolean {
  const word = table.words[cell];
  if (word === INVALID) return false;
  const unit = 2 ** (word >>> 27) * table.unit;
  out[0] = (word & 511) * unit;
  out[1] = ((word >>> 9) & 511) * unit;
  out[2] = ((word >>> 18) & 511) * unit;
  return true;
}

/** What of a material is on the GPU. */
export interface GpuMaterial {
  cells: WebGLTexture;
  table: Pick<Table, "unit" | "phiBins" | "error" | "resampled">;
  /** The half-vector table's words; null where the server has none, and draws follow the cosine. */
  words: WebGLTexture | null;
}

/** Words in front of the values of a run-time file, which are the sampler's; docs/export.md describes them. */
export function cutSampler(file: ArrayBuffer): Uint32Array {
  const head = new Uint32Array(file, 0, 32);
  if (head[0] !== 0x6c72656d || head[2] !== 1) throw new Error("the run-time file has another version than this page");
  const [tables, rows, segments] = [head[5], head[6], head[7]];
  const nodes = tables * rows * (segments + 1);
  const count =
    32 + tables + 2 * (rows + 1) + Math.ceil((tables * rows) / 2) + Math.ceil((tables * rows) / 4) + Math.ceil(nodes / 2);
  // A copy, so that the values can be forgotten.
  return new Uint32Array(file, 0, count).slice();
}

const uploaded = new Map<string, Promise<GpuMaterial>>();

/** Uploads a material once; the oldest of more than four is deleted. */
export function uploadMaterial(gpu: Gpu, source: Source, entry: Entry): Promise<GpuMaterial> {
  const key = String(entry.id);
  const known = uploaded.get(key);
  if (known) return known;
  const upload = loadTable(source, entry).then((table) => ({
    cells: makeWordTexture(gpu.gl, table.words, CELLS_ACROSS),
    table: { unit: table.unit, phiBins: table.phiBins, error: table.error, resampled: table.resampled },
    words: null,
  }));
  uploaded.set(key, upload);
  upload.catch(() => uploaded.delete(key));
  if (uploaded.size > 4) forget(gpu, uploaded.keys().next().value as string);
  return upload;
}

function forget(gpu: Gpu, key: string): void {
  const upload = uploaded.get(key);
  uploaded.delete(key);
  upload?.then(({ cells, words }) => {
    gpu.gl.deleteTexture(cells);
    gpu.gl.deleteTexture(words);
  });
}

/** Also uploads the half-vector table, if there is one to be had. */
export async function uploadSampler(gpu: Gpu, source: Source, entry: Entry): Promise<GpuMaterial> {
  const material = await uploadMaterial(gpu, source, entry);
  const key = makeKey("runtime", [["material", entry.id]]);
  if (!material.words && source.holds(key)) {
    const file = await source.bytes(key).catch(() => null);
    if (file && !material.words) material.words = makeWordTexture(gpu.gl, cutSampler(file), WORDS_ACROSS);
  }
  return material;
}
