/** How a film is shown. Pure. */
import type { Scale } from "./colour_maps.ts";
import type { Film, Region } from "./film.ts";
import { decades } from "./colour_maps.ts";
import type { Triple } from "./colour.ts";

/** In the order of the shader's numbers. */
export const shows = ["colour", "luminance", "error", "relative error", "samples", "invalid_samples", "difference"] as const;
export type Show = (typeof shows)[number];

export const tones = ["linear", "reinhard", "filmic"] as const;
export type Tone = (typeof tones)[number];

export interface Look {
  show: Show;
  /** What Y is multiplied by, per cd/m2. */
  exposure: number;
  /** XYZ that is to look white. */
  white: Triple;
  tone: Tone;
  warnClipped: boolean;
  warnGamut: boolean;
  /** Frames of who works on which tile. */
  workers: boolean;
  /** 0: the first image; 1: the second; between: a wipe. */
  side: "first" | "second" | "wipe";
  /** Where the wipe stands, 0 to 1. */
  wipe: number;
  scale: Scale;
  chosen: Region | undefined;
}

/** Middle grey, and the exposure that gives it to a luminance. */
export const middleGrey = 0.18;

export function autoExposure(film: Film): number {
  const mean = film.logarithmicMean();
  return mean > 0 ? middleGrey / mean : 1;
}

/** The scale of a view's colour map, from what the film has now. */
export function scaleOf(show: Show, film: Film): Scale {
  switch (show) {
    case "luminance":
      return decades(film.some(1));
    case "error":
      return decades(film.some(3));
    case "relative error":
      return { low: 1e-4, high: 1, logarithmic: true };
    case "samples": {
      const most = Math.max(1, ...[...film.tiles.values()].map((tile) => tile.samples));
      return { low: 0, high: most, logarithmic: false };
    }
    case "invalid_samples":
      return { low: 0, high: Math.max(1, ...[...film.tiles.values()].map((tile) => tile.invalid_samples)), logarithmic: false };
    case "difference":
      return { low: -4, high: 4, logarithmic: false };
    case "colour":
      return { low: 0, high: 1, logarithmic: false };
  }
}

/** What the numbers beside the colour map are. */
export const units: Record<Show, string> = {
  colour: "",
  luminance: "Luminance, cd/m²",
  error: "Standard error of luminance, cd/m²",
  "relative error": "Standard error over luminance",
  samples: "Samples per pixel",
  invalid_samples: "Invalid samples per tile",
  difference: "Difference in standard errors",
};
