/** The one WebGL 2 context: panels draw into it and copy the result to their own canvases, so that a texture is uploaded once. */

export interface Gpu {
  gl: WebGL2RenderingContext;
  canvas: HTMLCanvasElement;
  /** Format of a target that keeps sums; null if the GPU renders to none. */
  sums: number | null;
}

export function openGpu(): Gpu | null {
  const canvas = document.createElement("canvas");
  const gl = canvas.getContext("webgl2", { alpha: false, antialias: true, depth: true });
  if (!gl) return null;
  let sums: number | null = null;
  if (gl.getExtension("EXT_color_buffer_half_float")) sums = gl.RGBA16F;
  if (gl.getExtension("EXT_color_buffer_float")) sums = gl.RGBA32F;
  return { gl, canvas, sums };
}

/** A vertex shader for one triangle that covers the target; draw three vertices. */
export const COVER = `#version 300 es
void main() {
    vec2 corner = vec2(float((gl_VertexID << 1) & 2), float(gl_VertexID & 2));
    gl_Position = vec4(2.0 * corner - 1.0, 0.0, 1.0);
}
`;

export interface Program {
  program: WebGLProgram;
  uniforms: Record<string, WebGLUniformLocation>;
}

/** A program that the browser may still be compiling. */
export interface BegunProgram {
  program: WebGLProgram;
  shaders: WebGLShader[];
}

/** Hands a program to the browser, which compiles it while the page does other things: nothing is asked of it yet. */
export function beginProgram(gl: WebGL2RenderingContext, vertex: string, fragment: string): BegunProgram {
  const program = gl.createProgram()!;
  const shaders: WebGLShader[] = [];
  for (const [kind, text] of [
    [gl.VERTEX_SHADER, vertex],
    [gl.FRAGMENT_SHADER, fragment],
  ] as [number, string][]) {
    const shader = gl.createShader(kind)!;
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
    shaders.push(shader);
  }
  gl.linkProgram(program);
  return { program, shaders };
}

/** Waits for a program. */
export function finishProgram(gl: WebGL2RenderingContext, { program, shaders }: BegunProgram): Program {
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) {
    const logs = [gl.getProgramInfoLog(program), ...shaders.map((shader) => gl.getShaderInfoLog(shader))];
    throw new Error(`a shader does not compile: ${logs.filter(Boolean).join(" ")}`);
  }
  for (const shader of shaders) gl.deleteShader(shader);
  const uniforms: Record<string, WebGLUniformLocation> = {};
  const count: number = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS);
  for (let i = 0; i < count; i++) {
    const { name } = gl.getActiveUniform(program, i)!;
    uniforms[name] = gl.getUniformLocation(program, name)!;
  }
  return { program, uniforms };
}

/** A texture without filtering, as `internal` says, of `data` or of nothing. */
export function makeTexture(
  gl: WebGL2RenderingContext,
  [width, height]: [number, number],
  [internal, format, type]: [number, number, number],
  data: ArrayBufferView | null,
): WebGLTexture {
  const texture = gl.createTexture()!;
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
  gl.texImage2D(gl.TEXTURE_2D, 0, internal, width, height, 0, format, type, data);
  for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, gl.NEAREST);
  for (const name of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, name, gl.CLAMP_TO_EDGE);
  return texture;
}

/** Words of 32 bits in rows of `width`, the last of which is filled up with zeros. */
export function makeWordTexture(gl: WebGL2RenderingContext, words: Uint32Array, width: number): WebGLTexture {
  const height = Math.max(1, Math.ceil(words.length / width));
  let padded = words;
  if (words.length !== width * height) {
    padded = new Uint32Array(width * height);
    padded.set(words);
  }
  return makeTexture(gl, [width, height], [gl.R32UI, gl.RED_INTEGER, gl.UNSIGNED_INT], padded);
}

/** Makes textures the samplers of a program, one unit each. The one called `grid` has three dimensions. */
export function bindTextures(gl: WebGL2RenderingContext, { uniforms }: Program, textures: Record<string, WebGLTexture | null>): void {
  let unit = 0;
  for (const [name, texture] of Object.entries(textures)) {
    if (!uniforms[name]) continue;
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(name === "grid" ? gl.TEXTURE_3D : gl.TEXTURE_2D, texture);
    gl.uniform1i(uniforms[name], unit);
    unit += 1;
  }
}

/** Prepares the context's own canvas for a picture of this size. */
export function beginPicture({ gl, canvas }: Gpu, width: number, height: number): void {
  // A canvas that only grows keeps its memory; pictures are in its lower left corner.
  if (canvas.width < width) canvas.width = width;
  if (canvas.height < height) canvas.height = height;
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.viewport(0, 0, width, height);
}

/** Copies that picture to a place of a canvas in the same turn of the page. */
export function copyPicture(gpu: Gpu, [width, height]: [number, number], to: CanvasRenderingContext2D, box: [number, number, number, number]): void {
  to.drawImage(gpu.canvas, 0, gpu.canvas.height - height, width, height, ...box);
}
