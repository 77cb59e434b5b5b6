/** What is seen, as the URL's fragment keeps it: a link reproduces the view. */

export interface State {
  /** Names or formulas, one to three. */
  materials: string[];
  /** Direction of wo, degrees. */
  theta: number;
  phi: number;
  /** `sphere`, or a mesh's name; "" for the mesh that the server was started with, if any. */
  shape: string;
  normals: "flat" | "smooth";
  /** `directional`, or an environment's name. */
  light: string;
  lightTheta: number;
  lightPhi: number;
  /** Stops, of the sphere. */
  exposure: number;
  value: "f-cos" | "f";
  scale: "linear" | "log";
  /** The part of the polar plot that is seen, and that of the Cartesian one: see zoom.ts. */
  polarZoom: number;
  polarX: number;
  polarY: number;
  plotZoom: number;
  plotX: number;
  plotY: number;
  /** Viewpoint of the lobe, degrees. */
  elevation: number;
  azimuth: number;
  phiD: number;
  /** Of the slice of an anisotropic material. */
  phiH: number;
  slice: "colour" | "difference";
  sliceExposure: number;
  sampler: string;
  rival: string;
  /** Batches of draws. */
  batches: number;
  nMax: number;
  /** Whether draws are shown over the leaves. */
  over: "draws" | "nothing";
  map: string;
  strategy: "light" | "brdf" | "ris";
  keep: number;
  candidates: number;
}

export const DEFAULTS: State = {
  materials: [],
  theta: 30,
  phi: 0,
  shape: "",
  normals: "flat",
  light: "directional",
  lightTheta: 45,
  lightPhi: -35,
  exposure: 0,
  value: "f-cos",
  scale: "linear",
  polarZoom: 1,
  polarX: 0,
  polarY: 0,
  plotZoom: 1,
  plotX: 0,
  plotY: 0,
  elevation: 25,
  azimuth: 20,
  phiD: 90,
  phiH: 0,
  slice: "colour",
  sliceExposure: 0,
  sampler: "half-vector:64KB",
  rival: "cosine",
  batches: 1,
  nMax: 2,
  over: "draws",
  map: "studio",
  strategy: "light",
  keep: 1024,
  candidates: 8,
};

/** Least and greatest of each number, so that a bent link cannot break the page. */
const DOMAINS: Partial<Record<keyof State, [number, number]>> = {
  theta: [0, 89],
  phi: [0, 358],
  lightTheta: [0, 180],
  lightPhi: [-180, 180],
  exposure: [-10, 10],
  polarZoom: [1, 64],
  polarX: [0, 1],
  polarY: [0, 1],
  plotZoom: [1, 64],
  plotX: [0, 1],
  plotY: [0, 1],
  elevation: [0, 90],
  azimuth: [-180, 180],
  phiD: [0, 179],
  phiH: [0, 358],
  sliceExposure: [-10, 10],
  batches: [1, 64],
  nMax: [1.1, 16],
  keep: [16, 4096],
  candidates: [1, 64],
};

const WORDS: Partial<Record<keyof State, string[]>> = {
  normals: ["flat", "smooth"],
  value: ["f-cos", "f"],
  scale: ["linear", "log"],
  slice: ["colour", "difference"],
  over: ["draws", "nothing"],
  strategy: ["light", "brdf", "ris"],
};

export const MOST_MATERIALS = 3;

/** The state as a fragment without #; defaults are left out. */
export function writeFragment(state: State): string {
  const parts = state.materials.map((name) => `material=${encodeURIComponent(name)}`);
  for (const key of Object.keys(DEFAULTS) as (keyof State)[]) {
    if (key !== "materials" && state[key] !== DEFAULTS[key]) parts.push(`${key}=${encodeURIComponent(state[key] as string)}`);
  }
  return parts.join("&");
}

/** The state of a fragment; what it leaves out or gets wrong is the default. */
export function readFragment(fragment: string): State {
  const given = new URLSearchParams(fragment.replace(/^#/, ""));
  const state: State = { ...DEFAULTS, materials: given.getAll("material").slice(0, MOST_MATERIALS) };
  for (const key of Object.keys(DEFAULTS) as (keyof State)[]) {
    const text = given.get(key);
    if (text === null || key === "materials") continue;
    const value = readValue(key, text);
    if (value !== null) Object.assign(state, { [key]: value });
  }
  return state;
}

function readValue(key: keyof State, text: string): string | number | null {
  const domain = DOMAINS[key];
  if (domain) {
    const number = Number(text);
    return text.trim() && Number.isFinite(number) ? Math.min(Math.max(number, domain[0]), domain[1]) : null;
  }
  const words = WORDS[key];
  return words && !words.includes(text) ? null : text;
}

/** The entry of a sorted or unsorted list that is nearest to a number. */
export function findNearest(list: number[], value: number): number {
  return list.reduce((best, x) => (Math.abs(x - value) < Math.abs(best - value) ? x : best), list[0] ?? value);
}
