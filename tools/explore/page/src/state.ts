/** What is seen, as the URL's fragment keeps it: a link reproduces the view. */

export interface State {
  /** Names or formulas, one to three. */
  materials: string[];
  /** Direction of wo, degrees. */
  theta: number;
  phi: number;
  /** `directional`, or an environment's name. */
  light: string;
  lightTheta: number;
  lightPhi: number;
  /** Stops, of the sphere. */
  exposure: number;
  value: "f-cos" | "f";
  scale: "linear" | "log";
  /** Viewpoint of the lobe, degrees. */
  elevation: number;
  azimuth: number;
  phiD: number;
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
  light: "directional",
  lightTheta: 45,
  lightPhi: -35,
  exposure: 0,
  value: "f-cos",
  scale: "linear",
  elevation: 25,
  azimuth: 20,
  phiD: 90,
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
  elevation: [0, 90],
  azimuth: [-180, 180],
  phiD: [0, 179],
  sliceExposure: [-10, 10],
  batches: [1, 64],
  nMax: [1.1, 16],
  keep: [16, 4096],
  candidates: [1, 64],
};

const WORDS: Partial<Record<keyof State, string[]>> = {
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
