/** Spheres of the materials in view under parallel light or an environment, refined sample after sample. */

import { askBinary, makeKey, type Source } from "./data";
import { beginPicture, beginProgram, bindTextures, copyPicture, COVER, finishProgram, makeTexture, type BegunProgram, type Gpu, type Program } from "./gpu";
import { nameMaterials, nameMeshScene, quoteWord } from "./command";
import { bindSelect, bindSlider, onDrag, setCaption, type Frame, type Panel, type View } from "./panel";
import { drawTriangles, findMesh, uploadMesh, type GpuMesh } from "./mesh";
import { uploadMaterial, uploadSampler, type GpuMaterial } from "./table";
import backdropText from "../shaders/backdrop.glsl";
import merlkit from "../shaders/merlkit.glsl";
import meshText from "../shaders/mesh_fragment.glsl";
import meshVertex from "../shaders/mesh_vertex.glsl";
import sphereText from "../shaders/sphere.glsl";
import surfaceText from "../shaders/surface.glsl";
import tone from "../shaders/tone.glsl";

/** Samples of a pixel after which a picture is finished: smooth edges, and smooth light. */
const ENOUGH = { parallel: 32, sky: 1024 };
/** Milliseconds of a frame above which a moving picture is drawn with half the pixels across, and one at rest leaves time for others. */
const SLOW = 50;
/** Samples of a picture with half the pixels across, before one with all of them begins. */
const COARSE = { parallel: 1, sky: 64 };
/** The time that is left, milliseconds. */
const PAUSE = 50;

/** Two textures of sums, of which one is read and the other written. */
interface Sums {
  size: number;
  textures: [WebGLTexture, WebGLTexture];
  frames: [WebGLFramebuffer, WebGLFramebuffer];
  /** Distances of a mesh, for both frames. */
  depth: WebGLRenderbuffer;
  latest: number;
}

interface Run {
  name: string;
  materials: GpuMaterial[];
  sums: Sums[];
  sky: WebGLTexture | null;
  /** What is drawn instead of a sphere. */
  mesh: GpuMesh | null;
  count: number;
}

const begun = new Map<string, BegunProgram>();
const programs = new Map<string, Program>();
const skies = new Map<string, Promise<WebGLTexture>>();
/** Sums by the number of the sphere. */
const sums: Sums[] = [];
let current: Run | null = null;
/** Number of the latest picture: frames of earlier ones are dropped. */
let latest = 0;
/** Of the latest sample. Until one was drawn, the GPU may be slow. */
let milliseconds = Infinity;

/** What is drawn by a program of its own, and the texts that it is made of. */
const TEXTS = { sphere: [COVER, sphereText], backdrop: [COVER, backdropText], mesh: [meshVertex, meshText] };

/** Hands a program to the browser, unless that was done before. */
function begin(gpu: Gpu, name: string, vertex: string, fragment: string): void {
  if (!begun.has(name)) begun.set(name, beginProgram(gpu.gl, vertex, fragment));
}

function finish(gpu: Gpu, name: string): Program {
  const program = programs.get(name) ?? finishProgram(gpu.gl, begun.get(name)!);
  programs.set(name, program);
  return program;
}

function beginPart(gpu: Gpu, part: keyof typeof TEXTS, isSky: boolean, isGrid: boolean): string {
  const name = `${part} ${isSky} ${isGrid}`;
  const defines = `${isSky ? "#define LIGHT_IS_SKY\n" : ""}${isGrid ? "#define VALUES_ARE_GRID\n" : ""}`;
  const [vertex, fragment] = TEXTS[part];
  begin(gpu, name, vertex, `#version 300 es\n${defines}precision highp sampler3D;\n${merlkit}${surfaceText}${fragment}`);
  return name;
}

function getProgram(gpu: Gpu, part: keyof typeof TEXTS, isSky: boolean, isGrid: boolean): Program {
  return finish(gpu, beginPart(gpu, part, isSky, isGrid));
}

function getTone(gpu: Gpu): Program {
  begin(gpu, "tone", COVER, tone);
  return finish(gpu, "tone");
}

/** Hands what the first view will probably need to the browser, which compiles it while the page waits for values. */
export function prepareSpheres(gpu: Gpu, state: View["state"]): void {
  beginPart(gpu, "sphere", state.light !== "directional", false);
  begin(gpu, "tone", COVER, tone);
}

function loadSky(gpu: Gpu, source: Source, name: string): Promise<WebGLTexture> {
  let sky = skies.get(name);
  if (!sky) {
    const { gl } = gpu;
    sky = askBinary(source, makeKey("environment", [["name", name]])).then(({ members, arrays }) => {
      const [{ shape }] = members.arrays as { shape: number[] }[];
      return makeTexture(gl, [shape[1], shape[0]], [gl.RGB32F, gl.RGB, gl.FLOAT], arrays.radiance);
    });
    skies.set(name, sky);
    sky.catch(() => skies.delete(name));
  }
  return sky;
}

function getSums(gpu: Gpu, number: number, size: number): Sums {
  const { gl } = gpu;
  if (sums[number]?.size === size) return sums[number];
  for (const texture of sums[number]?.textures ?? []) gl.deleteTexture(texture);
  for (const frame of sums[number]?.frames ?? []) gl.deleteFramebuffer(frame);
  gl.deleteRenderbuffer(sums[number]?.depth ?? null);
  const depth = gl.createRenderbuffer()!;
  gl.bindRenderbuffer(gl.RENDERBUFFER, depth);
  gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT24, size, size);
  const made = [0, 1].map(() => {
    const texture = makeTexture(gl, [size, size], [gpu.sums!, gl.RGBA, gpu.sums === gl.RGBA16F ? gl.HALF_FLOAT : gl.FLOAT], null);
    const frame = gl.createFramebuffer()!;
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
    gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, depth);
    return { texture, frame };
  });
  sums[number] = { size, textures: [made[0].texture, made[1].texture], frames: [made[0].frame, made[1].frame], depth, latest: 0 };
  return sums[number];
}

/** One more sample of each pixel of a sphere, or of a mesh and of what is seen past it. */
function addSample(gpu: Gpu, run: Run, number: number, state: View["state"]): void {
  const { gl } = gpu;
  const { size, frames, latest: from } = run.sums[number];
  gl.bindFramebuffer(gl.FRAMEBUFFER, frames[1 - from]);
  gl.viewport(0, 0, size, size);
  gl.disable(gl.DEPTH_TEST);
  if (!run.mesh) {
    useProgram(gpu, run, number, state, "sphere");
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  } else {
    useProgram(gpu, run, number, state, "backdrop");
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    const { uniforms } = useProgram(gpu, run, number, state, "mesh");
    gl.uniform1i(uniforms.is_smooth, state.normals === "smooth" ? 1 : 0);
    gl.enable(gl.DEPTH_TEST);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    drawTriangles(gpu, run.mesh);
    gl.disable(gl.DEPTH_TEST);
  }
  run.sums[number].latest = 1 - from;
}

/** Steps of a lattice in two dimensions, by which a mesh is shifted within a pixel from one sample to the next. */
const STEPS = [0.7548776662, 0.5698402909];

/** Makes a program ready for a sample of a material. Uniforms that it has not are passed over. */
function useProgram(gpu: Gpu, run: Run, number: number, state: View["state"], part: keyof typeof TEXTS): Program {
  const { gl } = gpu;
  const { size, textures, latest: from } = run.sums[number];
  const { cells, grid, words, unit, phiBins } = run.materials[number];
  const program = getProgram(gpu, part, run.sky !== null, grid !== null);
  const { uniforms } = program;
  gl.useProgram(program.program);
  // A sampler without a texture of its type is an error even where nothing is read.
  bindTextures(gl, program, { cells, grid, merlkit_words: words ?? cells, before: textures[from], sky: run.sky });
  gl.uniform1f(uniforms.unit ?? null, unit);
  gl.uniform1i(uniforms.phi_bins ?? null, phiBins);
  gl.uniform2f(uniforms.size ?? null, size, size);
  gl.uniform1ui(uniforms.count ?? null, run.count);
  gl.uniform1i(uniforms.has_table ?? null, words ? 1 : 0);
  gl.uniform3f(uniforms.towards ?? null, ...aimLight(state.lightTheta, state.lightPhi));
  if (run.mesh) {
    gl.uniform3f(uniforms.eye ?? null, ...run.mesh.eye);
    gl.uniform1f(uniforms.half_height ?? null, run.mesh.halfHeight);
    // The first sample is at the pixel's centre.
    const [x, y] = STEPS.map((step) => (1 - 2 * ((0.5 + run.count * step) % 1)) / size);
    gl.uniform2f(uniforms.shift ?? null, x, y);
  }
  return program;
}

/** Towards the light: degrees from +y, and from the viewer's side (+z) to the right (+x), as `directional:THETA,PHI`. */
export function aimLight(theta: number, phi: number): [number, number, number] {
  const [t, p] = [(theta * Math.PI) / 180, (phi * Math.PI) / 180];
  return [Math.sin(t) * Math.sin(p), Math.cos(t), Math.sin(t) * Math.cos(p)];
}

/** Brings a sphere's sums to a place of the panel, `pixels` wide. */
function showSums(gpu: Gpu, run: Run, number: number, gain: number, pixels: number): void {
  const { gl } = gpu;
  const { size, textures, latest: from } = run.sums[number];
  const program = getTone(gpu);
  beginPicture(gpu, pixels, pixels);
  gl.useProgram(program.program);
  bindTextures(gl, program, { light: textures[from] });
  gl.uniform1f(program.uniforms.gain, gain);
  gl.uniform2f(program.uniforms.scale, size / pixels, size / pixels);
  gl.disable(gl.DEPTH_TEST);
  gl.drawArrays(gl.TRIANGLES, 0, 3);
}

/** What the sums of a run are of: whatever else changes, they are only shown again. */
function nameRun({ state, materials }: View, side: number): string {
  const light = state.light === "directional" ? [state.lightTheta, state.lightPhi] : [state.light];
  return [side, state.shape, state.normals, ...light, ...materials.map((entry) => entry.id)].join(" ");
}

async function drawSpheres(frame: Frame, view: View): Promise<string> {
  const { gpu, source, state, materials } = view;
  if (!gpu || gpu.sums === null) return "This browser has no WebGL 2 with float targets, so spheres are not drawn.";
  frame.aspect = 1 / Math.max(materials.length, 1);
  frame.begin();
  const side = Math.floor(frame.canvas.width / Math.max(materials.length, 1));
  const name = nameRun(view, side);
  if (current?.name !== name) {
    const sky = state.light === "directional" ? null : await loadSky(gpu, source, state.light);
    const entry = findMesh(view);
    const mesh = entry ? await uploadMesh(gpu, source, entry) : null;
    const upload = sky ? uploadSampler : uploadMaterial;
    const uploads = await Promise.all(materials.map((entry) => upload(gpu, source, entry)));
    const pixels = milliseconds > SLOW ? side >> 1 : side;
    current = { name, materials: uploads, sums: uploads.map((_, i) => getSums(gpu, i, pixels)), sky, mesh, count: 0 };
  } else if (current.count > 0) {
    showRun(frame, view, current, side);
  }
  const run = current;
  latest += 1;
  refine(frame, view, run, latest, side);
  return frame.section.querySelector(".caption")!.textContent!;
}

function showRun(frame: Frame, view: View, run: Run, side: number): void {
  for (let i = 0; i < run.materials.length; i++) {
    showSums(view.gpu!, run, i, 2 ** view.state.exposure, side);
    frame.context.setTransform(1, 0, 0, 1, 0, 0);
    copyPicture(view.gpu!, [side, side], frame.context, [i * side, frame.canvas.height - side, side, side]);
  }
}

/** Adds samples, one a frame of the screen, until there are enough or another picture is asked for. */
function refine(frame: Frame, view: View, run: Run, number: number, side: number): void {
  const gpu = view.gpu!;
  const enough = run.sky ? ENOUGH.sky : ENOUGH.parallel;
  function step(): void {
    if (number !== latest || run.count >= enough) return;
    setTimeout(() => requestAnimationFrame(step), milliseconds > SLOW ? PAUSE : 0);
    if (!frame.isSeen) return;
    // After the first samples of a slow moving picture the resting one gets all its pixels.
    if (run.count === (run.sky ? COARSE.sky : COARSE.parallel) && run.sums.some((s) => s.size !== side)) {
      run.sums = run.materials.map((_, i) => getSums(gpu, i, side));
      run.count = 0;
    }
    const begun = performance.now();
    for (let i = 0; i < run.materials.length; i++) addSample(gpu, run, i, view.state);
    run.count += 1;
    showRun(frame, view, run, side);
    if (run.sums[0].size === side) milliseconds = performance.now() - begun;
    describeRun(frame, view, run, enough);
  }
  requestAnimationFrame(step);
}

function describeRun(frame: Frame, { state, materials }: View, run: Run, enough: number): void {
  const light = run.sky
    ? `under ${state.light}, ${run.count} paths a pixel`
    : `under parallel light from ${state.lightTheta.toFixed(0)}°, ${state.lightPhi.toFixed(0)}° with irradiance π, ${run.count} samples a pixel`;
  const speed = run.count < enough && run.count > 1 ? `, ${(1000 / milliseconds).toFixed(0)} frames/s` : "";
  frame.canvas.dataset.samples = String(run.count);
  const shape = run.mesh ? ` on ${run.mesh.note}` : "";
  const notes = run.materials.map((material) => material.note).join("");
  setCaption(frame, `${materials.map((m) => m.name).join(", ")}${shape} ${light}${speed}.${notes}`, false);
}

/** The list of shapes, and that of normals while a mesh is shown. */
function addShapes(frame: Frame, view: () => View): void {
  bindSelect(frame, view, "shape", "shape", ["sphere", ...view().catalogue.meshes.map((mesh) => mesh.name)]);
  bindSelect(frame, view, "normals", "normals", ["flat", "smooth"]);
  const normals = frame.controls.lastElementChild as HTMLElement;
  function hideNormals(state: View["state"]): void {
    normals.hidden = state.shape === "sphere";
  }
  frame.syncs.push(hideNormals);
  hideNormals(view().state);
}

export const spherePanel: Panel = {
  id: "sphere",
  title: "Spheres",
  aspect: 1,
  depends: ["materials", "shape", "normals", "light", "lightTheta", "lightPhi", "exposure"],
  prepare(frame, view) {
    addShapes(frame, view);
    bindSelect(frame, view, "light", "light", ["directional", ...view().catalogue.environments]);
    bindSlider(frame, view, "exposure", "exposure", { min: -6, max: 6, step: 0.25, unit: " stops" });
    onDrag(frame.canvas, "Drag, or use the arrow keys, to move the light", (dx, dy) => {
      const { state, change } = view();
      const { lightTheta, lightPhi } = state;
      change({
        light: "directional",
        lightTheta: Math.min(Math.max(Math.round(lightTheta + dy / 2), 0), 180),
        lightPhi: Math.round(((lightPhi + dx / 2 + 540) % 360) - 180),
      });
    });
  },
  draw: drawSpheres,
  command(view) {
    const { state, materials } = view;
    const light = state.light === "directional" ? `directional:${state.lightTheta},${state.lightPhi}` : state.light;
    const background = state.light === "directional" ? " --background black" : "";
    const exposure = state.exposure ? ` --exposure=${state.exposure}` : "";
    const options = `--light ${quoteWord(light)}${background} --bounces 1${exposure}`;
    const mesh = findMesh(view);
    if (mesh) return nameMeshScene(mesh, materials[0], state.normals, options);
    return `merlkit render ${nameMaterials(materials)} ${options} --size ${512 * materials.length}x512 -o sphere`;
  },
};
