/** Words of commands. */

import type { Entry } from "./data";

/** A word as a shell reads it. */
export function quoteWord(word: string): string {
  return /^[\w@%+=:,./-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`;
}

/** Materials as a command's arguments. */
export function nameMaterials(materials: Entry[]): string {
  return materials.map((entry) => quoteWord(entry.text ?? entry.name)).join(" ");
}
