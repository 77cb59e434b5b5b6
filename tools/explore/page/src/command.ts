/** Words of commands. */

import type { Entry, MeshEntry } from "./data";

/** A word as a shell reads it. */
export function quoteWord(word: string): string {
  return /^[\w@%+=:,./-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`;
}

/** Materials as a command's arguments. */
export function nameMaterials(materials: Entry[]): string {
  return materials.map((entry) => quoteWord(entry.text ?? entry.name)).join(" ");
}

/** What writes a scene of a mesh and renders it: `merlkit render` takes meshes from scene files. */
export function nameMeshScene(mesh: MeshEntry, material: Entry, normals: string, options: string): string {
  const lines = [
    "[[material]]",
    'name = "material"',
    `brdf = ${JSON.stringify(material.text ?? material.name)}`,
    "[[object]]",
    'shape = "mesh"',
    `file = ${JSON.stringify(mesh.text ?? mesh.name)}`,
    'material = "material"',
    `smooth = ${normals === "smooth"}`,
  ];
  return `printf '%s\\n' ${lines.map(quoteWord).join(" ")} > scene.toml && merlkit render scene.toml ${options} --size 512x512 -o mesh`;
}
