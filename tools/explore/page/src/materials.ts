/** The materials in view: a list to choose from, formulas with sliders, fits on demand, and files that are dropped on the page. */

import { askJson, makeKey, type Catalogue, type Entry, type Source } from "./data";
import { addButton, addElement, addSelect, addSlider, type View } from "./panel";
import { MOST_MATERIALS } from "./state";

const resolved = new Map<string, Promise<Entry>>();

/** The entry of a name, or of a formula, which the server is told first. */
export function resolveMaterial(source: Source, catalogue: Catalogue, text: string): Promise<Entry> {
  const listed = catalogue.materials.find((entry) => entry.name === text);
  if (listed) return Promise.resolve(listed);
  let entry = resolved.get(text);
  if (!entry) {
    entry = askJson<Entry>(source, makeKey("formula", [["text", text]]));
    resolved.set(text, entry);
    entry.then(
      ({ name }) => resolved.set(name, entry!),
      () => resolved.delete(text),
    );
  }
  return entry;
}

/** A formula's text with another value of a parameter. */
export function replaceParameter(text: string, name: string, value: string): string {
  const [model, list = ""] = text.split(/:(.*)/s);
  const settings = list.split(",").filter((setting) => setting && !setting.startsWith(`${name}=`));
  return `${model}:${[...settings, `${name}=${value}`].join(",")}`;
}

/** The area with one row for each material in view. */
export function showMaterials(area: HTMLElement, view: () => View, say: (message: string) => void): void {
  area.replaceChildren();
  const { state, materials, catalogue, source, change } = view();
  const names = catalogue.materials.map((entry) => entry.name);
  state.materials.forEach((text, i) => {
    const row = addElement(area, "div", { class: `material series-${i}` });
    addSelect(row, ["first", "second", "third"][i], names, text, (name) => {
      change({ materials: view().state.materials.map((old, k) => (k === i ? name : old)) });
    });
    if (state.materials.length > 1) {
      addButton(row, "Remove", `Remove ${text}`, () => change({ materials: view().state.materials.filter((_, k) => k !== i) }));
    }
    const entry = materials.find((m) => m.name === text);
    if (!source.isStored) addFit(row, view, text, say);
    if (entry && !source.isStored) addParameters(row, view, entry, i);
    for (const note of entry?.notes ?? []) addElement(row, "p", { class: "note" }).textContent = note;
  });
  if (state.materials.length >= MOST_MATERIALS) return;
  const row = addElement(area, "div", { class: "material" });
  const free = names.find((name) => !state.materials.includes(name));
  if (free) addButton(row, "Add", "Show another material as well", () => change({ materials: [...view().state.materials, free] }));
  if (!source.isStored) addFormula(row, view);
}

function addFormula(row: HTMLElement, view: () => View): void {
  const none = "choose…";
  const { formulas } = view().catalogue;
  addSelect(row, "formula", [none, ...formulas.map((formula) => formula.name)], none, (name) => {
    const formula = formulas.find((known) => known.name === name);
    if (formula) view().change({ materials: [...view().state.materials, formula.text].slice(-MOST_MATERIALS) });
  });
  const form = addElement(row, "form");
  const label = addElement(form, "label");
  addElement(label, "span").textContent = "or its text";
  const input = addElement(label, "input", { type: "text", placeholder: "ward:sx=0.2,sy=0.2", size: "22", spellcheck: "false" });
  addElement(form, "button", { type: "submit" }).textContent = "Show";
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    const text = input.value.trim();
    if (text) view().change({ materials: [...view().state.materials, text].slice(-MOST_MATERIALS) });
  });
}

/** Sliders and lists of a formula's parameters. */
function addParameters(row: HTMLElement, view: () => View, entry: Entry, i: number): void {
  let text = entry.text ?? entry.name;
  function set(name: string, value: string): void {
    text = replaceParameter(text, name, value);
    const { state, change } = view();
    change({ materials: state.materials.map((old, k) => (k === i ? text : old)) }, true);
  }
  for (const parameter of entry.parameters) {
    const { name, kind, choices = [] } = parameter;
    if (kind === "choice") {
      addSelect(row, name, choices, String(parameter.value), (value) => set(name, value));
      continue;
    }
    const { min = 0, max = 1 } = parameter;
    const range = { min, max, step: (max - min) / 200, unit: "", isLog: min > 0 && max > 50 * min };
    if (kind === "number") {
      addSlider(row, name, range, Number(parameter.value), (value) => set(name, writeNumber(value)));
      continue;
    }
    const colour = [...(parameter.value as number[])];
    ["red", "green", "blue"].forEach((channel, c) => {
      addSlider(row, `${name} ${channel}`, range, colour[c], (value) => {
        colour[c] = value;
        set(name, colour.map(writeNumber).join("/"));
      });
    });
  }
}

function writeNumber(value: number): string {
  return String(Number(value.toPrecision(5)));
}

/** What the server says of a fit: the formula as a material, and errors as numbers of any name. */
type Fit = { material: string } & Record<string, unknown>;

/** Fits a model and shows the fit next to the material. */
function addFit(row: HTMLElement, view: () => View, text: string, say: (message: string) => void): void {
  const { catalogue } = view();
  if (!catalogue.models.length) return;
  let model = catalogue.models.includes("ggx") ? "ggx" : catalogue.models[0];
  addSelect(row, "fit", catalogue.models, model, (chosen) => (model = chosen));
  addButton(row, "Fit", `Fit a model to ${text} and show both`, (button) => {
    button.disabled = true;
    say(`Fitting ${model} to ${text}…`);
    fitMaterial(view, text, model)
      .then(say, (error: Error) => say(error.message))
      .finally(() => (button.disabled = false));
  });
}

async function fitMaterial(view: () => View, text: string, model: string): Promise<string> {
  const { source, catalogue, change } = view();
  const entry = await resolveMaterial(source, catalogue, text);
  const fit = await askJson<Fit>(source, makeKey("fit", [["material", entry.id], ["model", model]]));
  change({ materials: [text, fit.material], slice: "difference" });
  const numbers = Object.entries(fit).filter(([, value]) => typeof value === "number") as [string, number][];
  return `Fitted ${model} to ${text}. ${numbers.map(([name, value]) => `${name} ${Number(value.toPrecision(3))}`).join(", ")}`;
}

const MESH_NAMES = /\.(obj|ply|gltf|glb)$/i;

/** Sends a file, and shows the material or the mesh in it; returns its name. */
async function loadFile(view: () => View, file: File): Promise<string> {
  const { catalogue, source } = view();
  if (MESH_NAMES.test(file.name)) {
    const mesh = await source.sendMesh(file.name, file);
    catalogue.meshes = [...catalogue.meshes.filter((known) => known.name !== mesh.name), mesh];
    view().change({ shape: mesh.name });
    return mesh.name;
  }
  const entry = await source.send(file.name, file);
  catalogue.materials = [...catalogue.materials.filter((known) => known.name !== entry.name), entry];
  const others = view().state.materials.filter((name) => name !== entry.name);
  view().change({ materials: [...others, entry.name].slice(-MOST_MATERIALS) });
  return entry.name;
}

/** Loads files that are dropped on the page or chosen. */
export function acceptFiles(view: () => View, say: (message: string) => void): void {
  async function load(files: FileList | null | undefined): Promise<void> {
    for (const file of files ?? []) {
      say(`Loading ${file.name}…`);
      try {
        say(`Loaded ${await loadFile(view, file)}.`);
      } catch (error) {
        say(`${file.name}: ${(error as Error).message}`);
      }
    }
  }
  document.addEventListener("dragover", (event) => event.preventDefault());
  document.addEventListener("drop", (event) => {
    event.preventDefault();
    void load(event.dataTransfer?.files);
  });
  const input = document.getElementById("file") as HTMLInputElement;
  input.addEventListener("change", () => void load(input.files));
}
