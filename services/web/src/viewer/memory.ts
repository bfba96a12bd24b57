/** How an image is looked at, as the part of the address after "?": a link shows the same, and so does a reload. Pure. */
import { type Triple, whites } from "../image/colour.ts";
import type { Scale } from "../image/colour_maps.ts";
import type { Placement } from "../image/placement.ts";
import type { Region } from "../image/tiled_image.ts";
import { type Look, type Show, shows, type Tone, tones } from "../image/look.ts";

export interface Memory {
  show?: Show;
  tone?: Tone;
  exposure?: number;
  white?: Triple;
  ranges?: Look["ranges"];
  chosen?: Region;
  side?: Look["side"];
  wipe?: number;
  placement?: Placement;
}

/** What differs from how images are shown by themselves. */
export type Remembered = Pick<Look, "show" | "tone" | "exposure" | "white" | "ranges" | "chosen" | "side" | "wipe"> & {
  /** The exposure follows the image. */
  isAuto: boolean;
  /** Undefined: the whole image is in sight. */
  placement: Placement | undefined;
};

/** None: it is what the image has somewhere. */
export function nameOfWhite(white: Triple): keyof typeof whites | undefined {
  return (Object.keys(whites) as (keyof typeof whites)[]).find((name) => whites[name].every((value, index) => value === white[index]));
}

function whiteText(white: Triple): string {
  const name = nameOfWhite(white) ?? `${white[0].toFixed(4)},${white[2].toFixed(4)}`;
  return name === "D65" ? "" : name;
}

function rangeText(range: Scale | undefined): string | undefined {
  return range && `${range.low},${range.high},${range.logarithmic ? "log" : "linear"}`;
}

/** Empty: nothing differs. */
export function toQuery({ show, tone, exposure, white, ranges, chosen, side, wipe, isAuto, placement }: Remembered): string {
  const parts: [string, string | false | undefined][] = [
    ["view", show !== "colour" && show],
    ["tone", tone !== "reinhard" && tone],
    ["exposure", !isAuto && exposure.toPrecision(4)],
    ["white", whiteText(white)],
    ["range", rangeText(ranges[show])],
    ["region", chosen && [chosen.x, chosen.y, chosen.width, chosen.height].join()],
    ["at", placement && [placement.x.toFixed(1), placement.y.toFixed(1), placement.scale.toPrecision(3)].join()],
    ["side", side === "second" && side],
    ["wipe", side === "wipe" && wipe.toFixed(3)],
  ];
  const query = new URLSearchParams(parts.filter((part): part is [string, string] => Boolean(part[1])));
  return query.toString().replaceAll("%2C", ",");
}

/** What an address says; what it says wrongly is left out. */
export function fromQuery(text: string): Memory {
  const query = new URLSearchParams(text);
  const show = shows.find((each) => each === query.get("view"));
  const tone = tones.find((each) => each === query.get("tone"));
  const exposure = Number(query.get("exposure"));
  const white = whiteOf(query.get("white") ?? "");
  const range = rangeOf(query.get("range") ?? "");
  return {
    ...(show && { show }),
    ...(tone && { tone }),
    ...(exposure > 0 && Number.isFinite(exposure) && { exposure }),
    ...(white && { white }),
    ...(show && range && { ranges: { [show]: range } }),
    ...whereOf(query),
    ...sideOf(query),
  };
}

function whereOf(query: URLSearchParams): Pick<Memory, "chosen" | "placement"> {
  const chosen = regionOf(query.get("region") ?? "");
  const placement = placementOf(query.get("at") ?? "");
  return { ...(chosen && { chosen }), ...(placement && { placement }) };
}

function sideOf(query: URLSearchParams): Pick<Memory, "side" | "wipe"> {
  const wipe = Number(query.get("wipe") ?? NaN);
  if (wipe >= 0 && wipe <= 1) return { side: "wipe", wipe };
  return query.get("side") === "second" ? { side: "second" } : {};
}

/** By name, or X and Z where Y is 1. */
function whiteOf(text: string): Triple | undefined {
  const named = Object.entries(whites).find(([name]) => name === text)?.[1];
  const [x = NaN, z = NaN] = text.split(",").map(Number);
  return named ?? (x > 0 && z > 0 && Number.isFinite(x + z) ? [x, 1, z] : undefined);
}

function rangeOf(text: string): Scale | undefined {
  const [low = NaN, high = NaN] = text.split(",").map(Number);
  return high > low ? { low, high, logarithmic: low > 0 && text.endsWith("log") } : undefined;
}

function placementOf(text: string): Placement | undefined {
  const [x = NaN, y = NaN, scale = NaN] = text.split(",").map(Number);
  return x >= 0 && y >= 0 && scale > 0 && Number.isFinite(x + y + scale) ? { x, y, scale } : undefined;
}

function regionOf(text: string): Region | undefined {
  const parts = text.split(",").map(Number);
  const [x = -1, y = -1, width = 0, height = 0] = parts;
  return parts.every(Number.isInteger) && Math.min(x, y) >= 0 && Math.min(width, height) > 0 ? { x, y, width, height } : undefined;
}
