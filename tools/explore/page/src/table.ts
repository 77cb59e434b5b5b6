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

/** Nodes over phi_h, theta_h, theta_d and phi_d, as the server and surface.glsl have them. */
const NODES = [64, 64, 20, 24];
/** Blocks over theta_h that lie side by side in the texture, so that no side of it has more than 256 texels. */
const BLOCKS_ACROSS = 4;

/** What of a material is on the GPU. */
export interface GpuMaterial {
  /** Cells of a MERL table, or logarithms over four angles, of which one is null. */
  cells: WebGLTexture | null;
  grid: WebGLTexture | null;
  unit: number;
  phiBins: number;
  /** The half-vector table's words; null where the server has none, and draws follow the cosine. */
  words: WebGLTexture | null;
  /** What of it was resampled, as a sentence. */
  note: string;
}

async function uploadTable(gpu: Gpu, source: Source, entry: Entry): Promise<GpuMaterial> {
  const table = await loadTable(source, entry);
  const cells = makeWordTexture(gpu.gl, table.words, CELLS_ACROSS);
  const note = table.resampled ? ` ${entry.name} is resampled at the centres of MERL's bins.` : "";
  return { cells, grid: null, unit: table.unit, phiBins: table.phiBins, words: null, note };
}

function writePercent(fraction: number): string {
  return `${Number((100 * fraction).toPrecision(2))} %`;
}

/** An anisotropic material, resampled by the server: half floats in a texture that the GPU filters. */
async function uploadGrid({ gl }: Gpu, source: Source, entry: Entry): Promise<GpuMaterial> {
  const { members, arrays } = await askBinary(source, makeKey("grid", [["material", entry.id]]));
  const [phiH, thetaH, thetaD, phiD] = NODES;
  const block = 3 * phiH * thetaH * thetaD;
  if (arrays.log2?.length !== block * phiD) throw new Error(`the grid of ${entry.name} has another size: page and server differ in version`);
  const grid = gl.createTexture()!;
  gl.bindTexture(gl.TEXTURE_3D, grid);
  gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
  gl.texStorage3D(gl.TEXTURE_3D, 1, gl.RGB16F, phiH, BLOCKS_ACROSS * thetaH, (phiD / BLOCKS_ACROSS) * thetaD);
  for (let k = 0; k < phiD; k++) {
    const words = arrays.log2.subarray(k * block, (k + 1) * block);
    const corner: [number, number, number] = [0, (k % BLOCKS_ACROSS) * thetaH, Math.floor(k / BLOCKS_ACROSS) * thetaD];
    gl.texSubImage3D(gl.TEXTURE_3D, 0, ...corner, phiH, thetaH, thetaD, gl.RGB, gl.HALF_FLOAT, words);
  }
  for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_3D, name, gl.LINEAR);
  gl.texParameteri(gl.TEXTURE_3D, gl.TEXTURE_WRAP_S, gl.REPEAT);
  for (const name of [gl.TEXTURE_WRAP_T, gl.TEXTURE_WRAP_R]) gl.texParameteri(gl.TEXTURE_3D, name, gl.CLAMP_TO_EDGE);
  const errors = `half of its values move by less than ${writePercent(members.median as number)}, 99 of 100 by less than ${writePercent(members.percentile99 as number)}`;
  const note = ` ${entry.name} is anisotropic and resampled at ${thetaH} × ${phiH} × ${thetaD} × ${phiD} angles θh, φh, θd, φd: ${errors}.`;
  return { cells: null, grid, unit: 1, phiBins: 1, words: null, note };
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
  const upload = entry.isotropic ? uploadTable(gpu, source, entry) : uploadGrid(gpu, source, entry);
  uploaded.set(key, upload);
  upload.catch(() => uploaded.delete(key));
  if (uploaded.size > 4) forget(gpu, uploaded.keys().next().value as string);
  return upload;
}

function forget(gpu: Gpu, key: string): void {
  const upload = uploaded.get(key);
  uploaded.delete(key);
  upload?.then(({ cells, grid, words }) => {
    for (const texture of [cells, grid, words]) gpu.gl.deleteTexture(texture);
  });
}

/** Also uploads the half-vector table, if there is one to be had. */
export async function uploadSampler(gpu: Gpu, source: Source, entry: Entry): Promise<GpuMaterial> {
  const material = await uploadMaterial(gpu, source, entry);
  const key = makeKey("runtime", [["material", entry.id]]);
  if (entry.isotropic && !material.words && source.holds(key)) {
    const file = await source.bytes(key).catch(() => null);
    if (file && !material.words) material.words = makeWordTexture(gpu.gl, cutSampler(file), WORDS_ACROSS);
  }
  return material;
}
