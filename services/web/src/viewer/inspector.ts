/** What a pixel or a region of the image holds, in numbers. */
import { element, setText } from "../dom.ts";
import type { Film, Reading, Region } from "../image/film.ts";
import { chromaticity, colourTemperature, distanceFromLocus } from "../image/colour.ts";
import { formatCount, formatValue } from "../format.ts";

const rows: { label: string; value: (reading: Reading) => string }[] = [
  { label: "Luminance", value: ({ xyz }) => `${formatValue(xyz[1])}\u00a0cd/m²` },
  { label: "Std. error", value: errorText },
  { label: "X Y Z", value: ({ xyz }) => xyz.map((value) => formatValue(value)).join("  ") },
  { label: "x y", value: chromaticityText },
  { label: "CCT", value: temperatureText },
  { label: "Samples", value: ({ samples: [fewest, most] }) => (fewest === most ? formatCount(fewest) : `${formatCount(fewest)}–${formatCount(most)}`) },
  { label: "Invalid samples", value: ({ invalid_samples }) => `${formatCount(invalid_samples)} in tile` },
];

export interface Inspector {
  node: HTMLElement;
  /** Reads the film anew where it was looked at. */
  refresh: () => void;
  showPixel: (pixel: { x: number; y: number }) => void;
  showRegion: (region: Region | undefined) => void;
}

/** `film`: what is looked at now. */
export function inspector(film: () => Film | undefined): Inspector {
  const pixel = column("Pixel", "Point at the image, or use the arrow keys");
  const region = column("Region", "Drag with Shift, or press Region first");
  let at: Region | undefined;
  let chosen: Region | undefined;
  const refresh = (): void => {
    pixel.show(at && film()?.read(at));
    region.show(chosen && film()?.read(chosen));
  };
  return {
    node: element("div", { class: "inspector", role: "group", "aria-label": "Inspector" }, pixel.node, region.node),
    refresh,
    showPixel: ({ x, y }) => {
      const current = film();
      if (!current || x < 0 || y < 0 || x >= current.width || y >= current.height) return;
      at = { x, y, width: 1, height: 1 };
      refresh();
    },
    showRegion: (wanted) => {
      chosen = wanted;
      refresh();
    },
  };
}

function column(title: string, hint: string): { node: HTMLElement; show: (reading: Reading | undefined) => void } {
  const place = element("span", { class: "place" });
  const values = rows.map(() => element("dd"));
  const list = element("dl", {}, ...rows.map(({ label }, index) => element("div", {}, element("dt", {}, label), values[index] ?? "")));
  const invitation = element("p", { class: "note" }, hint);
  const node = element("section", { "aria-label": title }, element("h3", {}, title, place), invitation, list);
  list.hidden = true;
  return {
    node,
    show: (reading) => {
      list.hidden = !reading;
      invitation.hidden = !!reading;
      setText(place, reading ? placeText(reading) : "");
      if (reading) values.forEach((value, index) => { setText(value, rows[index]?.value(reading) ?? ""); });
    },
  };
}

function placeText({ region: { x, y, width, height } }: Reading): string {
  return width * height === 1 ? `${x}, ${y}` : `${x}, ${y}, ${width} × ${height}`;
}

function errorText({ standardError, xyz }: Reading): string {
  if (!Number.isFinite(standardError)) return "–";
  const relative = xyz[1] > 0 ? ` (${formatValue((100 * standardError) / xyz[1], 2)}\u00a0%)` : "";
  return `±\u00a0${formatValue(standardError, 3)}${relative}`;
}

function chromaticityText({ xyz }: Reading): string {
  const found = chromaticity(xyz);
  return found ? `${found.x.toFixed(4)}  ${found.y.toFixed(4)}` : "–";
}

function temperatureText({ xyz }: Reading): string {
  const found = chromaticity(xyz);
  const kelvin = found && colourTemperature(found);
  return found && kelvin ? `${Math.round(kelvin)}\u00a0K, Duv ${distanceFromLocus(found).toFixed(4)}` : "–";
}
