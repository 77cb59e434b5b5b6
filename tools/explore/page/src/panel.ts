/** A panel: title, controls, canvas, caption, and buttons for a screenshot and for the command that makes the same picture. */

import type { Catalogue, Entry, Source } from "./data";
import type { Gpu } from "./gpu";
import { savePicture } from "./png";
import { writeFragment, type State } from "./state";

/** What panels are drawn from. */
export interface View {
  state: State;
  /** Those of `state.materials` that are known, in their order. */
  materials: Entry[];
  catalogue: Catalogue;
  source: Source;
  gpu: Gpu | null;
  /** `keepControls` leaves the sliders of formulas as they are, because one of them is moving. */
  change(patch: Partial<State>, keepControls?: boolean): void;
}

export interface Panel {
  id: string;
  title: string;
  /** Height over width of the canvas. */
  aspect: number;
  /** Members of the state on which the picture depends. */
  depends: (keyof State)[];
  /** Adds controls, once. */
  prepare?(frame: Frame, view: () => View): void;
  /** Draws; what it returns is the caption. */
  draw(frame: Frame, view: View): Promise<string> | string;
  /** The command that makes the same, or null where there is none. */
  command(view: View): string | null;
}

export interface Frame {
  section: HTMLElement;
  canvas: HTMLCanvasElement;
  context: CanvasRenderingContext2D;
  controls: HTMLElement;
  /** CSS pixels of the canvas. */
  size(): [number, number];
  /** Brings the canvas to its size on the screen; drawing then counts in CSS pixels. */
  begin(): [number, number];
  isSeen: boolean;
  /** Height over width of the canvas. */
  aspect: number;
  /** Bring controls to the state, each time that it changes. */
  syncs: ((state: State) => void)[];
}

const MOST_PIXELS_PER_PIXEL = 2;

export function makeFrame(panel: Panel, parent: HTMLElement, view: () => View): Frame {
  const section = addElement(parent, "section", { id: panel.id });
  const head = addElement(section, "header");
  addElement(head, "h2").textContent = panel.title;
  const controls = addElement(section, "div", { class: "controls" });
  const canvas = addElement(section, "canvas", { role: "img", "aria-label": panel.title });
  addElement(section, "p", { class: "caption", "aria-live": "polite" });
  addButton(head, "PNG", `Save ${panel.title} as a PNG picture`, () => {
    const { state, catalogue } = view();
    void savePicture(canvas, panel.id, {
      Software: `merlkit ${catalogue.version} explore`,
      Title: `${panel.title}: ${state.materials.join(", ")}`,
      Source: panel.command(view()) ?? "",
      Comment: `#${writeFragment(state)}`,
    });
  });
  addButton(head, "Command", `Copy the command that makes ${panel.title}`, (button) => {
    void copyText(panel.command(view()), button);
  });
  const context = canvas.getContext("2d")!;
  const frame: Frame = {
    section,
    canvas,
    context,
    controls,
    isSeen: false,
    aspect: panel.aspect,
    syncs: [],
    size: () => {
      const width = Math.max(canvas.clientWidth, 64);
      return [width, Math.round(width * frame.aspect)];
    },
    begin: () => {
      const [width, height] = frame.size();
      const scale = Math.min(devicePixelRatio || 1, MOST_PIXELS_PER_PIXEL);
      const [across, down] = [Math.round(width * scale), Math.round(height * scale)];
      if (canvas.width !== across || canvas.height !== down) {
        canvas.width = across;
        canvas.height = down;
      }
      canvas.style.aspectRatio = `${width} / ${height}`;
      context.setTransform(across / width, 0, 0, down / height, 0, 0);
      context.clearRect(0, 0, width, height);
      return [width, height];
    },
  };
  // Its place on the page, without measuring it: that would lay the page out once a panel.
  canvas.style.aspectRatio = `1 / ${panel.aspect}`;
  panel.prepare?.(frame, view);
  return frame;
}

export function setCaption(frame: Frame, text: string, isError: boolean): void {
  const caption = frame.section.querySelector<HTMLElement>(".caption")!;
  if (caption.textContent !== text) caption.textContent = text;
  caption.classList.toggle("error", isError);
}

async function copyText(text: string | null, button: HTMLButtonElement): Promise<void> {
  const said = button.textContent;
  try {
    if (text !== null) await navigator.clipboard.writeText(text);
    button.textContent = text === null ? "No command makes this" : "Copied";
  } catch {
    // Where the clipboard is closed to pages, the text is shown to be copied by hand.
    button.textContent = text;
  }
  setTimeout(() => (button.textContent = said), 4000);
}

export function addElement<K extends keyof HTMLElementTagNameMap>(
  parent: HTMLElement,
  name: K,
  attributes: Record<string, string> = {},
): HTMLElementTagNameMap[K] {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  return parent.appendChild(element);
}

export function addButton(parent: HTMLElement, text: string, title: string, act: (button: HTMLButtonElement) => void): HTMLButtonElement {
  const button = addElement(parent, "button", { type: "button", title });
  button.textContent = text;
  button.addEventListener("click", () => act(button));
  return button;
}

export interface SliderRange {
  min: number;
  max: number;
  step: number;
  unit: string;
  /** Even steps of the logarithm: for what has a least value above 0 and spans decades. */
  isLog?: boolean;
}

/** A slider with its value behind it; `act` is called while it moves. */
export function addSlider(parent: HTMLElement, name: string, range: SliderRange, value: number, act: (value: number) => void): (value: number) => void {
  const label = addElement(parent, "label", { class: "slider" });
  addElement(label, "span").textContent = name;
  const { min, max, step } = range.isLog ? { min: Math.log(range.min), max: Math.log(range.max), step: 0.01 } : range;
  const input = addElement(label, "input", { type: "range", min: `${min}`, max: `${max}`, step: `${step}` });
  const output = addElement(label, "output");
  function show(shown: number): void {
    input.value = String(range.isLog ? Math.log(shown) : shown);
    output.textContent = `${Number(shown.toPrecision(4))}${range.unit}`;
  }
  input.addEventListener("input", () => {
    const chosen = range.isLog ? Math.exp(Number(input.value)) : Number(input.value);
    show(chosen);
    act(chosen);
  });
  show(value);
  return show;
}

/** A list to choose from; returns what shows another choice. */
export function addSelect(parent: HTMLElement, name: string, options: string[], value: string, act: (value: string) => void): (value: string) => void {
  const label = addElement(parent, "label");
  addElement(label, "span").textContent = name;
  const select = addElement(label, "select");
  for (const option of options) addElement(select, "option", { value: option }).textContent = option;
  select.addEventListener("change", () => act(select.value));
  function show(shown: string): void {
    if (![...select.options].some((option) => option.value === shown)) {
      addElement(select, "option", { value: shown }).textContent = shown;
    }
    select.value = shown;
  }
  show(value);
  return show;
}

type NumberKey = { [K in keyof State]: State[K] extends number ? K : never }[keyof State];
type WordKey = { [K in keyof State]: State[K] extends string ? K : never }[keyof State];

/** A slider of a member of the state. */
export function bindSlider(frame: Frame, view: () => View, name: string, key: NumberKey, range: SliderRange): void {
  const show = addSlider(frame.controls, name, range, view().state[key], (value) => view().change({ [key]: value }));
  frame.syncs.push((state) => show(state[key]));
}

/** A list for a member of the state. */
export function bindSelect(frame: Frame, view: () => View, name: string, key: WordKey, options: string[]): void {
  const show = addSelect(frame.controls, name, options, view().state[key], (value) => view().change({ [key]: value }));
  frame.syncs.push((state) => show(state[key]));
}

/** Calls `move` with the steps of a drag in CSS pixels, and with steps of arrow keys as if they were drags. */
export function onDrag(canvas: HTMLCanvasElement, hint: string, move: (dx: number, dy: number, event: PointerEvent | KeyboardEvent) => void): void {
  canvas.classList.add("draggable");
  canvas.tabIndex = 0;
  canvas.title = hint;
  canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
  canvas.addEventListener("pointermove", (event) => {
    if (canvas.hasPointerCapture(event.pointerId)) move(event.movementX, event.movementY, event);
  });
  const keys: Record<string, [number, number]> = { ArrowLeft: [-8, 0], ArrowRight: [8, 0], ArrowUp: [0, -8], ArrowDown: [0, 8] };
  canvas.addEventListener("keydown", (event) => {
    const step = keys[event.key];
    if (!step) return;
    event.preventDefault();
    move(step[0], step[1], event);
  });
}
