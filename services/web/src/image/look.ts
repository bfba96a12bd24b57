/** How an image is shown. Pure. */
import type { Scale } from "./colour_maps.ts";
import type { TiledImage, Region } from "./tiled_image.ts";
import { shownUnit } from "../format.ts";
import { decades } from "./colour_maps.ts";
import type { Triple } from "./colour.ts";
import type { Render } from "../service/types.ts";

/** In the order of the shader's numbers. */
export const shows = ["colour", "luminance", "error", "relative error", "samples", "invalid_samples", "difference"] as const;
export type Show = (typeof shows)[number];

export const tones = ["linear", "reinhard", "filmic"] as const;
export type Tone = (typeof tones)[number];

export interface Look {
  show: Show;
  /** What Y is multiplied by, per unit. */
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
  /** Scales that somebody set, by view; the others follow the image. */
  ranges: Partial<Record<Show, Scale>>;
  chosen: Region | undefined;
  measured: Measured;
}

/** Middle grey, and the exposure that gives it to a luminance. */
export const middleGrey = 0.18;

export function autoExposure(image: TiledImage): number {
  const mean = image.logarithmicMean();
  return mean > 0 ? middleGrey / mean : 1;
}

/** The scale of a view's colour map, from what the image has now. */
export function scaleOf(show: Show, image: TiledImage): Scale {
  switch (show) {
    case "luminance":
      return decades(image.some(1));
    case "error":
      return decades(image.some(3));
    case "relative error":
      return { low: 1e-4, high: 1, logarithmic: true };
    case "samples":
      return { low: 0, high: image.most((tile) => tile.samples), logarithmic: false };
    case "invalid_samples":
      return { low: 0, high: image.most((tile) => tile.invalid_samples), logarithmic: false };
    case "difference":
      return { low: -4, high: 4, logarithmic: false };
    case "colour":
      return { low: 0, high: 1, logarithmic: false };
  }
}

/** What Y is of an image, and its mean over pixels. */
export interface Measured {
  quantity: string;
  unit: string;
  mean: number;
}

/** What an image's numbers are; those of older renders are not named. */
export function measured({ quantity, unit, progress }: Pick<Render, "quantity" | "unit" | "progress">): Measured {
  return { quantity: quantity || "Y", unit: shownUnit(unit), mean: progress.mean };
}

/** What the numbers beside the colour map are. */
export function legendTitle(show: Show, { quantity, unit }: Measured): string {
  const ofUnit = unit ? `, ${unit}` : "";
  const titles: Record<Show, string> = {
    colour: "",
    luminance: `${capital(quantity)}${ofUnit}`,
    error: `Standard error of ${quantity}${ofUnit}`,
    "relative error": "Relative error: σ / √(Y² + 0.01 M²), M the image's mean",
    samples: "Samples per pixel",
    invalid_samples: "Invalid samples per tile",
    difference: "Difference in standard errors",
  };
  return titles[show];
}

export function capital(text: string): string {
  return text.charAt(0).toUpperCase() + text.slice(1);
}
