/** The page: state, materials and panels, drawn when they are seen and what they depend on has changed. */

import { cartesianPanel, polarPanel } from "./charts";
import { askJson, makeKey, openSource, readToken, type Catalogue, type Entry, type Source } from "./data";
import { discPanel } from "./disc";
import { drawsPanel } from "./draws";
import { environmentPanel } from "./environment";
import { openGpu, type Gpu } from "./gpu";
import { askLobe, lobePanel, prepareLobes } from "./lobe";
import { acceptFiles, resolveMaterial, showMaterials } from "./materials";
import { addElement, addSlider, makeFrame, setCaption, type Frame, type Panel, type View } from "./panel";
import { rowsPanel } from "./rows";
import { slicePanel } from "./slice";
import { prepareSpheres, spherePanel } from "./sphere";
import { DEFAULTS, readFragment, writeFragment, type State } from "./state";
import { loadTable } from "./table";

const PANELS: Panel[] = [spherePanel, lobePanel, polarPanel, cartesianPanel, slicePanel, drawsPanel, discPanel, rowsPanel, environmentPanel];

/** Milliseconds after which a panel says that it is waiting for an answer. */
const PATIENCE = 400;

interface Shown {
  panel: Panel;
  frame: Frame;
  /** Whether what is on the canvas is not that of the state. */
  isStale: boolean;
  isDrawing: boolean;
}

function say(message: string): void {
  document.getElementById("status")!.textContent = message;
}

async function start(): Promise<void> {
  const source = openSource();
  const asking = askJson<Catalogue>(source, makeKey("materials", []));
  const gpu = openGpu();
  const begun = readFragment(location.hash);
  askFirst(source, begun);
  if (gpu) {
    prepareSpheres(gpu, begun);
    prepareLobes(gpu);
  }
  const catalogue = await asking;
  const view = makeView(source, catalogue, gpu);
  await resolveAll(view);
  askTables(view);
  const shown: Shown[] = [];
  const main = document.querySelector("main")!;
  for (const panel of PANELS) shown.push({ panel, frame: makeFrame(panel, main, () => view), isStale: true, isDrawing: false });
  const bar = document.getElementById("direction")!;
  const syncs = addDirection(bar, view);
  const area = document.getElementById("materials")!;
  showMaterials(area, () => view, say);
  const isFileHidden = source.isStored;
  document.getElementById("load")!.hidden = isFileHidden;
  document.getElementById("version")!.textContent = `merlkit ${catalogue.version}`;

  let queued = false;
  function queue(): void {
    if (queued) return;
    queued = true;
    requestAnimationFrame(() => {
      queued = false;
      for (const item of shown) void drawIfSeen(item, view);
    });
  }
  function makeStale(keys: (keyof State)[]): void {
    for (const item of shown) {
      if (item.panel.depends.some((key) => keys.includes(key))) item.isStale = true;
      for (const sync of item.frame.syncs) sync(view.state);
    }
    for (const sync of syncs) sync(view.state);
    queue();
  }
  view.change = (patch, keepControls = false) => {
    const keys = (Object.keys(patch) as (keyof State)[]).filter((key) => patch[key] !== view.state[key]);
    if (!keys.length) return;
    Object.assign(view.state, patch);
    rememberState(view.state);
    if (!keys.includes("materials")) return makeStale(keys);
    void resolveAll(view).then(() => {
      if (!keepControls) showMaterials(area, () => view, say);
      makeStale(keys);
    });
  };
  acceptFiles(() => view, say);
  watchScreen(shown, queue);
  window.addEventListener("hashchange", () => {
    if (location.hash !== addressOf(view.state)) view.change(withDefault(readFragment(location.hash), catalogue));
  });
  queue();
}

/** Asks for the first lobe before it is known what else there is: a page without a material shows the first. */
function askFirst(source: Source, state: State): void {
  if (state.materials.length || source.isStored) return;
  askLobe(source, 0, state.theta, 0).catch(() => {});
}

/** Asks for the tables of the spheres, which are the most bytes of the first view, before the panels are made. */
function askTables({ source, gpu, materials }: View): void {
  if (!gpu) return;
  for (const entry of materials) if (entry.isotropic) loadTable(source, entry).catch(() => {});
}

function makeView(source: Source, catalogue: Catalogue, gpu: Gpu | null): View {
  const state = withDefault(readFragment(location.hash), catalogue);
  return { state, materials: [], catalogue, source, gpu, change: () => {} };
}

/** A state that names no material or no known map takes the first. */
function withDefault(state: State, catalogue: Catalogue): State {
  if (!state.materials.length && catalogue.materials.length) state.materials = [catalogue.materials[0].name];
  if (!catalogue.environments.includes(state.map)) state.map = catalogue.environments[0] ?? DEFAULTS.map;
  if (!["directional", ...catalogue.environments].includes(state.light)) state.light = DEFAULTS.light;
  if (!["sphere", ...catalogue.meshes.map((mesh) => mesh.name)].includes(state.shape)) state.shape = catalogue.meshes[0]?.name ?? "sphere";
  return state;
}

async function resolveAll(view: View): Promise<void> {
  const texts = view.state.materials;
  const entries: Entry[] = [];
  for (const text of texts) {
    try {
      entries.push(await resolveMaterial(view.source, view.catalogue, text));
    } catch (error) {
      say(`${text}: ${(error as Error).message}`);
    }
  }
  // Later texts may have been resolved meanwhile. Formulas are called as the server writes them from now on.
  if (texts !== view.state.materials) return;
  view.materials = entries;
  if (entries.length) view.state.materials = entries.map((entry) => entry.name);
}

let remembering = 0;

/** The fragment of a state, behind the server's token if there is one. */
function addressOf(state: State): string {
  const token = readToken();
  return `#${[token && `token=${token}`, writeFragment(state)].filter(Boolean).join("&")}`;
}

/** Browsers refuse an address that changes many times a second. */
function rememberState(state: State): void {
  clearTimeout(remembering);
  remembering = window.setTimeout(() => history.replaceState(null, "", addressOf(state)), 250);
}

/** The sliders of wo, which most panels have in common. */
function addDirection(bar: HTMLElement, view: View): ((state: State) => void)[] {
  const theta = addSlider(bar, "wo: theta", { min: 0, max: 89, step: 1, unit: "°" }, view.state.theta, (x) => view.change({ theta: x }));
  const phi = addSlider(bar, "phi", { min: 0, max: 358, step: 2, unit: "°" }, view.state.phi, (x) => view.change({ phi: x }));
  const note = addElement(bar, "span", { class: "note" });
  if (view.catalogue.stored) note.textContent = `Exported page: angles go to the nearest of ${view.catalogue.stored.thetas.join("°, ")}°.`;
  return [(state) => theta(state.theta), (state) => phi(state.phi)];
}

/** Draws a panel until it shows the latest state; one drawing at a time. */
async function drawIfSeen(item: Shown, view: View): Promise<void> {
  const { panel, frame } = item;
  if (item.isDrawing || !item.isStale || !frame.isSeen) return;
  item.isDrawing = true;
  while (item.isStale && frame.isSeen) {
    item.isStale = false;
    const waiting = setTimeout(() => setCaption(frame, "Computing…", false), PATIENCE);
    try {
      const caption = await panel.draw(frame, view);
      if (caption) setCaption(frame, caption, false);
      frame.canvas.setAttribute("aria-label", `${panel.title}. ${caption}`);
      frame.section.dataset.drawn = String(Number(frame.section.dataset.drawn ?? 0) + 1);
    } catch (error) {
      frame.begin();
      setCaption(frame, (error as Error).message, true);
    } finally {
      clearTimeout(waiting);
    }
  }
  item.isDrawing = false;
}

/** Panels are drawn when they come into sight, change their size, or the scheme of colours changes. */
function watchScreen(shown: Shown[], queue: () => void): void {
  const items = new Map(shown.map((item) => [item.frame.section as Element, item]));
  const sight = new IntersectionObserver(
    (entries) => {
      for (const entry of entries) items.get(entry.target)!.frame.isSeen = entry.isIntersecting;
      queue();
    },
    { rootMargin: "100px" },
  );
  for (const { frame } of shown) sight.observe(frame.section);
  function redraw(): void {
    for (const item of shown) item.isStale = true;
    queue();
  }
  let width = innerWidth;
  window.addEventListener("resize", () => {
    if (width !== innerWidth) redraw();
    width = innerWidth;
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
}

start().catch((error: Error) => say(error.message));
