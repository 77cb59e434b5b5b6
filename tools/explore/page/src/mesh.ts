/** Meshes that take the place of the sphere: on the GPU, where they are rasterised. */

import { askBinary, makeKey, type MeshEntry, type Source } from "./data";
import type { Gpu } from "./gpu";
import type { View } from "./panel";

/** A mesh on the GPU. Its surrounding sphere is the unit sphere about the origin. */
export interface GpuMesh {
  array: WebGLVertexArrayObject;
  buffers: WebGLBuffer[];
  /** Corners of all triangles. */
  corners: number;
  eye: [number, number, number];
  /** Half of the picture's height at the distance 1. */
  halfHeight: number;
  /** What it is, for the caption. */
  note: string;
}

/** The mesh that is to be shown, or null for the sphere. */
export function findMesh({ state, catalogue }: View): MeshEntry | null {
  return catalogue.meshes.find((mesh) => mesh.name === state.shape) ?? null;
}

/** The mesh that was asked for last; others leave the GPU. */
let uploaded: { id: number; mesh: Promise<GpuMesh> } | null = null;

export function uploadMesh(gpu: Gpu, source: Source, entry: MeshEntry): Promise<GpuMesh> {
  if (uploaded?.id === entry.id) return uploaded.mesh;
  uploaded?.mesh.then(({ array, buffers }) => {
    gpu.gl.deleteVertexArray(array);
    for (const buffer of buffers) gpu.gl.deleteBuffer(buffer);
  }, () => {});
  const mesh = loadMesh(gpu, source, entry);
  uploaded = { id: entry.id, mesh };
  mesh.catch(() => (uploaded = null));
  return mesh;
}

async function loadMesh({ gl }: Gpu, source: Source, entry: MeshEntry): Promise<GpuMesh> {
  const { members, arrays } = await askBinary(source, makeKey("mesh", [["mesh", entry.id]]));
  const array = gl.createVertexArray()!;
  gl.bindVertexArray(array);
  const buffers: WebGLBuffer[] = [];
  [arrays.positions, arrays.normals].forEach((vectors, place) => {
    const buffer = gl.createBuffer()!;
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, vectors, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, 3, gl.FLOAT, false, 0, 0);
    buffers.push(buffer);
  });
  const indices = gl.createBuffer()!;
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, indices);
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, arrays.faces, gl.STATIC_DRAW);
  gl.bindVertexArray(null);
  const left = entry.dropped ? `, and ${entry.dropped} of no area left out` : "";
  return {
    array,
    buffers: [...buffers, indices],
    corners: arrays.faces.length,
    eye: members.eye as [number, number, number],
    halfHeight: Math.tan((members.vertical_angle as number) / 2),
    note: `${entry.name} (${entry.faces} triangles${left}; it casts no shadow on itself)`,
  };
}

export function drawTriangles({ gl }: Gpu, { array, corners }: GpuMesh): void {
  gl.bindVertexArray(array);
  gl.drawElements(gl.TRIANGLES, corners, gl.UNSIGNED_INT, 0);
  gl.bindVertexArray(null);
}
