/** Colours: Okabe and Ito's for materials and samplers, viridis for values, the library's tone curve for light. */

/** Every eighth of viridis, as the library's plots have it. */
const VIRIDIS = [
  [68, 1, 84],
  [71, 44, 122],
  [59, 81, 139],
  [44, 113, 142],
  [33, 144, 141],
  [39, 173, 129],
  [92, 200, 99],
  [170, 220, 50],
  [253, 231, 37],
];

export type Rgb = [number, number, number];

/** 8-bit sRGB of a value in [0, 1]; values outside take the nearer end, NaN the dark one. */
export function viridis(value: number): Rgb {
  const position = value > 0 ? Math.min(value, 1) * (VIRIDIS.length - 1) : 0;
  const i = Math.min(Math.floor(position), VIRIDIS.length - 2);
  const t = position - i;
  return [0, 1, 2].map((c) => Math.round(VIRIDIS[i][c] * (1 - t) + VIRIDIS[i + 1][c] * t)) as Rgb;
}

/** 8-bit sRGB of a signed value in [-1, 1]: blue below 0, orange above, grey at 0. */
export function diverging(value: number): Rgb {
  const t = Math.min(Math.abs(value), 1);
  const end = value < 0 ? [0, 114, 178] : [230, 130, 0];
  return [0, 1, 2].map((c) => Math.round(236 * (1 - t) + end[c] * t)) as Rgb;
}

/** The tone curve of the library's PNG pictures: a line up to one half, then an exponential shoulder. */
export function mapTone(x: number): number {
  if (!(x > 0.5)) return x > 0 ? x : 0;
  return 0.5 - 0.5 * Math.expm1(1 - 2 * x);
}

/** 8-bit sRGB of linear light. */
export function encodeSrgb(x: number): number {
  const y = mapTone(x);
  return Math.round(255 * (y <= 0.0031308 ? 12.92 * y : 1.055 * y ** (1 / 2.4) - 0.055));
}

/** The colours that the style sheet gives the page at this moment. */
export interface Theme {
  ink: string;
  soft: string;
  faint: string;
  paper: string;
  series: string[];
}

export function readTheme(): Theme {
  const style = getComputedStyle(document.documentElement);
  function colour(name: string): string {
    return style.getPropertyValue(name).trim();
  }
  return {
    ink: colour("--ink"),
    soft: colour("--soft"),
    faint: colour("--faint"),
    paper: colour("--paper"),
    series: [colour("--first"), colour("--second"), colour("--third")],
  };
}

/** A colour such as #0072b2 as numbers from 0 to 1. */
export function readHex(colour: string): Rgb {
  const number = parseInt(colour.slice(1), 16);
  return [(number >> 16) / 255, ((number >> 8) & 255) / 255, (number & 255) / 255];
}
