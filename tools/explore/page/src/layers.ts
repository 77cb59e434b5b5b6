/** Solids that show through one another: each is drawn alone, and the layers are put over one another pixel by pixel, the nearest on top. */

import { beginPicture, beginProgram, bindTextures, COVER, finishProgram, makeTexture, type Gpu, type Program } from "./gpu";
import layersText from "../shaders/layers.glsl";

/** Solids that a picture can have. */
const MOST = 3;
/** Samples of a pixel along each side, which smooth its edges: the least, and the most, which small pictures have. */
const FINENESS = [2, 4];
/** Texels of a side that more samples are taken up to, and texels that no layer has more of. */
const USUAL = 1200;
const WIDEST = 4096;

function chooseFineness(side: number): number {
  const [least, most] = FINENESS;
  if (least * side > WIDEST) return 1;
  return Math.min(Math.max(Math.floor(USUAL / side), least), most);
}

interface Layer {
  frame: WebGLFramebuffer;
  colour: WebGLTexture;
  depth: WebGLTexture;
}

let layers: { size: [number, number]; all: Layer[] } | null = null;
let program: Program | null = null;

function makeLayer(gl: WebGL2RenderingContext, size: [number, number]): Layer {
  const colour = makeTexture(gl, size, [gl.RGBA8, gl.RGBA, gl.UNSIGNED_BYTE], null);
  const depth = makeTexture(gl, size, [gl.DEPTH_COMPONENT24, gl.DEPTH_COMPONENT, gl.UNSIGNED_INT], null);
  const frame = gl.createFramebuffer()!;
  gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, colour, 0);
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, depth, 0);
  return { frame, colour, depth };
}

/** Layers of a size, of which the latest are kept. */
function findLayers(gl: WebGL2RenderingContext, size: [number, number], count: number): Layer[] {
  if (layers?.size[0] === size[0] && layers.size[1] === size[1] && layers.all.length >= count) return layers.all;
  for (const { frame, colour, depth } of layers?.all ?? []) {
    gl.deleteFramebuffer(frame);
    gl.deleteTexture(colour);
    gl.deleteTexture(depth);
  }
  layers = { size, all: Array.from({ length: count }, () => makeLayer(gl, size)) };
  return layers.all;
}

/** Calls `draw` for each of `count` solids, and brings them over `paper` to the context's canvas. */
export function drawLayers(gpu: Gpu, [width, height]: [number, number], paper: [number, number, number], count: number, draw: (solid: number) => void): void {
  const { gl } = gpu;
  if (count === 0) return;
  const fineness = chooseFineness(Math.max(width, height));
  const size: [number, number] = [fineness * width, fineness * height];
  const all = findLayers(gl, size, count);
  gl.viewport(0, 0, ...size);
  gl.enable(gl.DEPTH_TEST);
  for (let solid = 0; solid < count; solid++) {
    gl.bindFramebuffer(gl.FRAMEBUFFER, all[solid].frame);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    draw(solid);
  }
  program ??= finishProgram(gl, beginProgram(gl, COVER, layersText));
  beginPicture(gpu, width, height);
  gl.useProgram(program.program);
  const textures: Record<string, WebGLTexture> = {};
  // The shader passes over those behind the last solid.
  for (let i = 0; i < MOST; i++) {
    const { colour, depth } = all[Math.min(i, all.length - 1)];
    textures[`colour${i}`] = colour;
    textures[`depth${i}`] = depth;
  }
  bindTextures(gl, program, textures);
  gl.uniform3f(program.uniforms.paper, ...paper);
  gl.uniform1i(program.uniforms.count, count);
  gl.uniform1i(program.uniforms.fineness, fineness);
  gl.disable(gl.DEPTH_TEST);
  gl.drawArrays(gl.TRIANGLES, 0, 3);
}
