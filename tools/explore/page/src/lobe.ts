/** The lobe of f or f cos over the hemisphere of wi, as solids that share one scale; and what it was asked from. */

import { askBinary, makeKey, type Answer, type Entry, type Source } from "./data";
import { readHex, readTheme } from "./colours";
import { drawLegend } from "./axes";
import { nameMaterials } from "./command";
import { beginPicture, beginProgram, copyPicture, finishProgram, type BegunProgram, type Gpu, type Program } from "./gpu";
import { drawLayers } from "./layers";
import { addSelect, onDrag, type Frame, type Panel, type View } from "./panel";
import { findNearest, type State } from "./state";
import vertexText from "../shaders/lobe_vertex.glsl";
import fragmentText from "../shaders/lobe_fragment.glsl";

export const ROWS = 90;
export const COLUMNS = 180;
/** Decades of a logarithmic radius. */
export const DECADES = 4;
/** CSS pixels of a drag for one degree. */
const PIXELS_PER_DEGREE = 2;

export type Direction = [number, number, number];

export interface Lobe {
  entry: Entry;
  /** f by [row, column, rgb]; wi has theta (row + 1/2) degrees and phi 2 column degrees. */
  f: Float32Array;
  /** Degrees by which what is shown is turned about the normal: isotropic materials are asked for phi 0. */
  turn: number;
  theta: number;
}

/** The polar angle that can be asked for: in an exported page the nearest that it holds. */
export function snapTheta({ state, catalogue }: View): number {
  return catalogue.stored ? findNearest(catalogue.stored.thetas, state.theta) : state.theta;
}

/** The azimuth that a material is asked for. */
export function askedPhi(entry: Entry, state: State): number {
  return entry.isotropic ? 0 : 2 * Math.round(state.phi / 2);
}

export function askLobe(source: Source, id: Entry["id"], theta: number, phi: number): Promise<Answer> {
  const key = makeKey("lobe", [
    ["material", id],
    ["theta", theta],
    ["phi", phi],
    ["rows", ROWS],
    ["columns", COLUMNS],
  ]);
  return askBinary(source, key);
}

export async function loadLobe(source: Source, entry: Entry, theta: number, state: State): Promise<Lobe> {
  const { arrays } = await askLobe(source, entry.id, theta, askedPhi(entry, state));
  return { entry, f: arrays.f as Float32Array, turn: entry.isotropic ? state.phi : 0, theta };
}

/** Mean of red, green and blue of f or f cos at a row and a column. */
export function readLobe(lobe: Lobe, row: number, column: number, value: State["value"]): number {
  const i = 3 * (row * COLUMNS + ((column % COLUMNS) + COLUMNS) % COLUMNS);
  const mean = (lobe.f[i] + lobe.f[i + 1] + lobe.f[i + 2]) / 3;
  return value === "f" ? mean : mean * Math.cos(((row + 0.5) * Math.PI) / 180);
}

export function findGreatest(lobes: Lobe[], value: State["value"]): number {
  let greatest = 0;
  for (const lobe of lobes) {
    for (let row = 0; row < ROWS; row++) {
      for (let column = 0; column < COLUMNS; column++) greatest = Math.max(greatest, readLobe(lobe, row, column, value));
    }
  }
  return greatest;
}

/** Length of a lobe at a value: its fraction of the greatest, or of DECADES decades below it. */
export function scaleRadius(value: number, greatest: number, scale: State["scale"]): number {
  if (!(value > 0 && greatest > 0)) return 0;
  return scale === "linear" ? value / greatest : Math.max(0, 1 + Math.log10(value / greatest) / DECADES);
}

export function makeDirection(theta: number, phi: number): Direction {
  const [t, p] = [(theta * Math.PI) / 180, (phi * Math.PI) / 180];
  return [Math.sin(t) * Math.cos(p), Math.sin(t) * Math.sin(p), Math.cos(t)];
}

/** Vertices [row, column] of a lobe with the pole in front, and the triangles between them. */
export function makeMesh(lobe: Lobe, greatest: number, state: State): { positions: Float32Array; indices: Uint16Array } {
  const positions = new Float32Array(3 * (1 + ROWS * COLUMNS));
  const indices: number[] = [];
  let pole = 0;
  for (let column = 0; column < COLUMNS; column++) pole += readLobe(lobe, 0, column, state.value) / COLUMNS;
  positions[2] = scaleRadius(pole, greatest, state.scale);
  for (let row = 0; row < ROWS; row++) {
    for (let column = 0; column < COLUMNS; column++) {
      const radius = scaleRadius(readLobe(lobe, row, column, state.value), greatest, state.scale);
      const direction = makeDirection(row + 0.5, 2 * column + lobe.turn);
      const here = 1 + row * COLUMNS + column;
      for (let axis = 0; axis < 3; axis++) positions[3 * here + axis] = radius * direction[axis];
      const next = 1 + row * COLUMNS + ((column + 1) % COLUMNS);
      if (row === 0) indices.push(0, here, next);
      else indices.push(here - COLUMNS, here, next, here - COLUMNS, next, next - COLUMNS);
    }
  }
  return { positions, indices: new Uint16Array(indices) };
}

/** Axes of the picture: to the right, up, and to the viewer. At azimuth 0, wo of phi 0 is on the left. */
export function makeAxes(elevation: number, azimuth: number): [Direction, Direction, Direction] {
  const [e, p] = [(elevation * Math.PI) / 180, ((90 - azimuth) * Math.PI) / 180];
  const back: Direction = [Math.cos(p) * Math.cos(e), Math.sin(p) * Math.cos(e), Math.sin(e)];
  const right: Direction = [-Math.sin(p), Math.cos(p), 0];
  const up: Direction = [-Math.cos(p) * Math.sin(e), -Math.sin(p) * Math.sin(e), Math.cos(e)];
  return [right, up, back];
}

function dot(a: Direction, b: Direction): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

let begun: BegunProgram | null = null;
let program: Program | null = null;
let buffers: { vertices: WebGLBuffer; indices: WebGLBuffer; array: WebGLVertexArrayObject } | null = null;

function drawMesh({ gl }: Gpu, mesh: ReturnType<typeof makeMesh>): void {
  if (!buffers) {
    buffers = { vertices: gl.createBuffer()!, indices: gl.createBuffer()!, array: gl.createVertexArray()! };
    gl.bindVertexArray(buffers.array);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffers.vertices);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffers.indices);
  }
  gl.bindVertexArray(buffers.array);
  gl.bindBuffer(gl.ARRAY_BUFFER, buffers.vertices);
  gl.bufferData(gl.ARRAY_BUFFER, mesh.positions, gl.DYNAMIC_DRAW);
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, mesh.indices, gl.DYNAMIC_DRAW);
  gl.drawElements(gl.TRIANGLES, mesh.indices.length, gl.UNSIGNED_SHORT, 0);
  gl.bindVertexArray(null);
}

/** Half the width of the picture in radii of the hemisphere. */
const HALF_WIDTH = 1.25;

/** Hands the program of lobes to the browser, which compiles it meanwhile. */
export function prepareLobes(gpu: Gpu): void {
  begun ??= beginProgram(gpu.gl, vertexText, fragmentText);
}

function drawSolids(gpu: Gpu, frame: Frame, lobes: Lobe[], greatest: number, state: State): void {
  const { gl } = gpu;
  const { canvas, context } = frame;
  prepareLobes(gpu);
  program ??= finishProgram(gl, begun!);
  const theme = readTheme();
  const size: [number, number] = [canvas.width, canvas.height];
  gl.useProgram(program.program);
  const [right, up, back] = makeAxes(state.elevation, state.azimuth);
  gl.uniformMatrix3fv(program.uniforms.view, true, [...right, ...up, ...back]);
  gl.uniform2f(program.uniforms.scale, 1 / HALF_WIDTH, canvas.width / canvas.height / HALF_WIDTH);
  gl.uniform1f(program.uniforms.base, shiftUp(state.elevation));
  function drawSolid(i: number): void {
    gl.uniform3f(program!.uniforms.colour, ...readHex(theme.series[i]));
    drawMesh(gpu, makeMesh(lobes[i], greatest, state));
  }
  if (lobes.length === 1) {
    beginPicture(gpu, ...size);
    gl.clearColor(...readHex(theme.paper), 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    drawSolid(0);
  } else {
    drawLayers(gpu, size, readHex(theme.paper), lobes.length, drawSolid);
  }
  context.setTransform(1, 0, 0, 1, 0, 0);
  copyPicture(gpu, size, context, [0, 0, ...size]);
}

/** By how much the picture is moved up, in radii: the outline of the hemisphere reaches from -sin(elevation) to 1. */
function shiftUp(elevation: number): number {
  return 0.5 * (Math.sin((elevation * Math.PI) / 180) - 1);
}

/** The base circle, wo and its mirror direction over the solids. */
function drawGuides(frame: Frame, view: View, theta: number): void {
  const { context } = frame;
  const [width, height] = frame.size();
  const { state } = view;
  const theme = readTheme();
  const [right, up] = makeAxes(state.elevation, state.azimuth);
  const unit = width / 2 / HALF_WIDTH;
  const scale = frame.canvas.width / width;
  context.setTransform(scale, 0, 0, scale, 0, 0);
  function project(p: Direction): [number, number] {
    return [width / 2 + unit * dot(p, right), height / 2 - unit * (dot(p, up) + shiftUp(state.elevation))];
  }
  context.strokeStyle = theme.faint;
  context.lineWidth = 1;
  context.beginPath();
  for (let phi = 0; phi <= 360; phi += 4) context.lineTo(...project(makeDirection(90, phi)));
  context.stroke();
  context.fillStyle = theme.ink;
  context.font = "13px system-ui, sans-serif";
  context.textAlign = "center";
  for (const [name, phi, dashes] of [
    ["wo", state.phi, []],
    ["mirror", state.phi + 180, [4, 4]],
  ] as [string, number, number[]][]) {
    const end = project(makeDirection(theta, phi));
    context.strokeStyle = theme.ink;
    context.setLineDash(dashes);
    context.beginPath();
    context.moveTo(...project([0, 0, 0]));
    context.lineTo(...end);
    context.stroke();
    context.fillText(name, end[0], end[1] - 6);
  }
  context.setLineDash([]);
  const names = view.materials.map((entry, i) => ({ name: entry.name, colour: theme.series[i], points: [] }));
  drawLegend(context, names, { left: 0, top: 0, width, height }, theme);
}

export const lobePanel: Panel = {
  id: "lobe",
  title: "Lobe",
  aspect: 0.85,
  depends: ["materials", "theta", "phi", "value", "scale", "elevation", "azimuth"],
  prepare(frame, view) {
    const drag = { turns: "wo" };
    addSelect(frame.controls, "drag moves", ["wo", "the viewpoint"], drag.turns, (turns) => (drag.turns = turns));
    onDrag(frame.canvas, "Drag, or use the arrow keys, to move wo; with Shift, the viewpoint", (dx, dy, event) => {
      const { state, change } = view();
      if (drag.turns === "wo" && !event.shiftKey) {
        // wo follows the pointer: outwards on its side is towards the horizon.
        const side = Math.cos(((state.azimuth - state.phi) * Math.PI) / 180) < 0 ? -1 : 1;
        change({
          theta: Math.round(Math.min(Math.max(state.theta - (side * dx) / PIXELS_PER_DEGREE, 0), 89)),
          phi: (state.phi + 2 * Math.round(dy / 2 / PIXELS_PER_DEGREE) + 360) % 360,
        });
      } else {
        change({
          azimuth: ((Math.round(state.azimuth - dx / PIXELS_PER_DEGREE) + 540) % 360) - 180,
          elevation: Math.min(Math.max(Math.round(state.elevation + dy / PIXELS_PER_DEGREE), 0), 90),
        });
      }
    });
  },
  async draw(frame, view) {
    const { state, materials, source, gpu } = view;
    const theta = snapTheta(view);
    const lobes = await Promise.all(materials.map((entry) => loadLobe(source, entry, theta, state)));
    frame.begin();
    const greatest = findGreatest(lobes, state.value);
    if (gpu) drawSolids(gpu, frame, lobes, greatest, state);
    drawGuides(frame, view, theta);
    const radius = state.scale === "linear" ? "the radius is linear" : `the radius covers ${DECADES} decades`;
    const what = state.value === "f" ? "f_r" : "f_r·cosθi";
    return `${what}, mean of red, green and blue, for wo at ${theta}°, ${state.phi}°; ${radius}, greatest ${greatest.toPrecision(3)} sr⁻¹.`;
  },
  command({ state, materials }) {
    const names = nameMaterials(materials);
    const together = materials.length > 1 ? " --together" : "";
    const { theta, value, scale, elevation, azimuth } = state;
    return `merlkit plot ${names} --kind lobe-3d --theta ${theta} --value ${value} --scale ${scale} --elevation ${elevation} --azimuth=${azimuth}${together}`;
  },
};
