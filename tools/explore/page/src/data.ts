/** The one way to data: keys such as `api/v1/albedo?material=0&theta=30&phi=0`, answered by the server or by the page itself. */

/** A parameter of a formula: a number, red, green and blue, or one of some words. */
export interface Parameter {
  name: string;
  meaning: string;
  kind: "number" | "colour" | "choice";
  min?: number;
  max?: number;
  value: number | number[] | string;
  choices?: string[];
}

export interface Entry {
  id: number | string;
  name: string;
  kind: string;
  isotropic: boolean;
  notes: string[];
  /** Whether there is a MERL table. */
  table: boolean;
  /** How commands call it; null for what was sent by the page. */
  text: string | null;
  parameters: Parameter[];
}

/** A mesh that can take the place of the sphere. */
export interface MeshEntry {
  id: number;
  name: string;
  faces: number;
  /** Triangles of no area that were left out. */
  dropped: number;
  /** Its path; null for what was sent by the page. */
  text: string | null;
}

/** Values that an exported page holds answers for. */
export interface Stored {
  thetas: number[];
  /** Azimuths that slices of anisotropic materials are held at. */
  phi_h: number[];
  phi_d: number[];
  n_max: number[];
  samplers: string[];
  count: number;
  seed: number;
}

export interface Catalogue {
  version: string;
  materials: Entry[];
  meshes: MeshEntry[];
  samplers: { text: string }[];
  environments: string[];
  models: string[];
  formulas: { name: string; summary: string; text: string }[];
  stored: Stored | null;
}

export type Numbers = Float32Array | Uint32Array | Uint16Array | Uint8Array;

/** A binary answer: its JSON members, and its arrays by name. */
export interface Answer {
  members: Record<string, unknown>;
  arrays: Record<string, Numbers>;
}

export interface Source {
  isStored: boolean;
  /** Whether a key can be asked for: any of a server's, and what an exported page holds. */
  holds(key: string): boolean;
  bytes(key: string): Promise<ArrayBuffer>;
  /** Sends a file with a material to the server; returns its entry. */
  send(name: string, file: Blob): Promise<Entry>;
  /** The same with a mesh. */
  sendMesh(name: string, file: Blob): Promise<MeshEntry>;
}

const MAGIC = "MKXPLOR1";
const KINDS = { f32: Float32Array, u32: Uint32Array, u16: Uint16Array, u8: Uint8Array };
/** Bytes of answers that are kept, the latest of them. */
const MOST_KEPT = 64e6;

export function openSource(): Source {
  const mode = document.querySelector<HTMLMetaElement>("meta[name=merlkit-mode]")?.content;
  return mode === "stored" ? openStored() : openLive();
}

/** The word that the server demands. It lies in the fragment, which browsers send to nobody. */
export function readToken(): string {
  return new URLSearchParams(location.hash.slice(1)).get("token") ?? "";
}

function openLive(): Source {
  const token = readToken();
  const headers = { "X-Merlkit-Token": token };

  async function request(key: string, options: RequestInit): Promise<Response> {
    const response = await fetch(`/${key}`, { ...options, headers });
    if (!response.ok) throw new Error((await response.text()).trim() || `the server answers ${response.status}`);
    return response;
  }

  async function post<T>(path: string, name: string, body: Blob): Promise<T> {
    return (await request(`api/v1/${path}?name=${encodeURIComponent(name)}`, { method: "POST", body })).json();
  }

  return {
    isStored: false,
    holds: () => true,
    bytes: async (key) => (await request(key, {})).arrayBuffer(),
    send: (name, file) => post("materials", name, file),
    sendMesh: (name, file) => post("meshes", name, file),
  };
}

function openStored(): Source {
  const data = document.getElementById("data");
  const answers: Record<string, string> = JSON.parse(data?.textContent ?? "{}");
  const isCompressed = data?.dataset.encoding === "gzip";
  return {
    isStored: true,
    holds: (key) => Object.hasOwn(answers, key),
    bytes: async (key) => {
      if (!Object.hasOwn(answers, key)) throw new Error("This exported page does not hold that. Run merlkit explore to see it.");
      const bytes = decodeBase64(answers[key]);
      return isCompressed ? decompress(bytes) : bytes;
    },
    send: refuseFile,
    sendMesh: refuseFile,
  };
}

async function refuseFile(): Promise<never> {
  throw new Error("An exported page loads no files. Run merlkit explore to load them.");
}

function decodeBase64(text: string): ArrayBuffer {
  const characters = atob(text);
  const bytes = new Uint8Array(characters.length);
  for (let i = 0; i < bytes.length; i++) bytes[i] = characters.charCodeAt(i);
  return bytes.buffer;
}

function decompress(bytes: ArrayBuffer): Promise<ArrayBuffer> {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
}

/** The answer in a buffer that starts with the magic word, the length of a JSON header and the header. */
export function parseAnswer(buffer: ArrayBuffer): Answer {
  const view = new DataView(buffer);
  const magic = buffer.byteLength >= 12 ? new TextDecoder().decode(new Uint8Array(buffer, 0, 8)) : "";
  if (magic !== MAGIC) throw new Error(`an answer starts with "${magic}" instead of ${MAGIC}: page and server differ in version`);
  const length = view.getUint32(8, true);
  const members = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 12, length)));
  const arrays: Record<string, Numbers> = {};
  let offset = alignToEight(12 + length);
  for (const { name, type, shape } of members.arrays as { name: string; type: keyof typeof KINDS; shape: number[] }[]) {
    const count = shape.reduce((product, side) => product * side, 1);
    const array = new KINDS[type](buffer, offset, count);
    arrays[name] = array;
    offset = alignToEight(offset + array.byteLength);
  }
  return { members, arrays };
}

function alignToEight(offset: number): number {
  return Math.ceil(offset / 8) * 8;
}

interface Kept {
  answer: Promise<unknown>;
  /** 0 until it has arrived. */
  bytes: number;
}

/** Answers by key, the one asked for last at the end. */
const kept = new Map<string, Kept>();

function keep<T>(source: Source, key: string, parse: (buffer: ArrayBuffer) => T): Promise<T> {
  const known = kept.get(key);
  if (known) {
    kept.delete(key);
    kept.set(key, known);
    return known.answer as Promise<T>;
  }
  const made: Kept = { answer: Promise.resolve(), bytes: 0 };
  const answer = source.bytes(key).then((buffer) => {
    made.bytes = buffer.byteLength;
    forgetOldest();
    return parse(buffer);
  });
  made.answer = answer;
  kept.set(key, made);
  answer.catch(() => kept.delete(key));
  return answer;
}

function forgetOldest(): void {
  let total = 0;
  for (const [key, { bytes }] of [...kept].reverse()) {
    total += bytes;
    if (total > MOST_KEPT && bytes > 0) kept.delete(key);
  }
}

export function askBinary(source: Source, key: string): Promise<Answer> {
  return keep(source, key, parseAnswer);
}

export function askJson<T>(source: Source, key: string): Promise<T> {
  return keep(source, key, (buffer) => JSON.parse(new TextDecoder().decode(buffer)) as T);
}

/** A key from a path and its parameters, in the order given. */
export function makeKey(path: string, parameters: [string, string | number][]): string {
  const query = parameters.map(([name, value]) => `${name}=${encodeURIComponent(value)}`);
  return `api/v1/${path}${query.length ? `?${query.join("&")}` : ""}`;
}
