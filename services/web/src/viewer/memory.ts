/** How an image is looked at, as the part of the address after "?": a link shows the same, and so does a reload. Pure. */
import type { Scale } from "../image/colour_maps.ts";
import type { Placement } from "../image/placement.ts";
import type { Region } from "../image/tiled_image.ts";
import { type Look, type Show, shows, type Tone, tones } from "../image/look.ts";

export interface Memory {
  show?: Show;
  tone?: Tone;
  exposure?: number;
  ranges?: Look["ranges"];
  chosen?: Region;
  side?: Look["side"];
  wipe?: number;
  placement?: Placement;
}

/** What differs from how images are shown by themselves. */
export type Remembered = Pick<Look, "show" | "tone" | "exposure" | "ranges" | "chosen" | "side" | "wipe"> & {
  /** The exposure follows the image. */
  isAuto: boolean;
  /** Undefined: the whole image is in sight. */
  placement: Placement | undefined;
};

/** Empty: nothing differs. */
export function toQuery({ show, tone, exposure, ranges, chosen, side, wipe, isAuto, placement }: Remembered): string {
  const query = new URLSearchParams();
  if (show !== "colour") query.set("view", show);
  if (tone !== "reinhard") query.set("tone", tone);
  if (!isAuto) query.set("exposure", exposure.toPrecision(4));
  const range = ranges[show];
  if (range) query.set("range", `${range.low},${range.high},${range.logarithmic ? "log" : "linear"}`);
  if (chosen) query.set("region", [chosen.x, chosen.y, chosen.width, chosen.height].join());
  if (placement) query.set("at", [placement.x.toFixed(1), placement.y.toFixed(1), placement.scale.toPrecision(3)].join());
  if (side === "second") query.set("side", side);
  if (side === "wipe") query.set("wipe", wipe.toFixed(3));
  return query.toString().replaceAll("%2C", ",");
}

/** What an address says; what it says wrongly is left out. */
export function fromQuery(text: string): Memory {
  const query = new URLSearchParams(text);
  const show = shows.find((each) => each === query.get("view"));
  const tone = tones.find((each) => each === query.get("tone"));
  const exposure = Number(query.get("exposure"));
  const range = rangeOf(query.get("range") ?? "");
  return {
    ...(show && { show }),
    ...(tone && { tone }),
    ...(exposure > 0 && Number.isFinite(exposure) && { exposure }),
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
