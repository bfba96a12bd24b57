/** What a pixel or a region of the image holds, in numbers. */
import { element, setText } from "../dom.ts";
import type { Film, Reading, Region } from "../image/film.ts";
import { chromaticity, colourTemperature, distanceFromLocus } from "../image/colour.ts";
import { formatCount, formatValue } from "../format.ts";
import { capital, type Measured } from "../image/look.ts";

const rows: { label: string | ((measured: Measured) => string); value: (reading: Reading, measured: Measured) => string }[] = [
  { label: ({ quantity }) => capital(quantity), value: ({ xyz }, { unit }) => (xyz[1] > 0 ? `${formatValue(xyz[1])}\u00a0${unit}`.trimEnd() : "nothing seen") },
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

/** `film`: what is looked at now; `measured`: what its numbers are. */
export function inspector(film: () => Film | undefined, measured: () => Measured): Inspector {
  const pixel = column("Pixel", "Point at the image, or use the arrow keys", measured);
  const region = column("Region", "Drag with Shift, or press Region first", measured);
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

function column(title: string, hint: string, measured: () => Measured): { node: HTMLElement; show: (reading: Reading | undefined) => void } {
  const place = element("span", { class: "place" });
  const values = rows.map(() => element("dd"));
  const names = rows.map(() => element("dt"));
  const list = element("dl", {}, ...names.map((name, index) => element("div", {}, name, values[index] ?? "")));
  const invitation = element("p", { class: "note" }, hint);
  const node = element("section", { "aria-label": title }, element("h3", {}, title, place), invitation, list);
  list.hidden = true;
  return {
    node,
    show: (reading) => {
      list.hidden = !reading;
      invitation.hidden = !!reading;
      setText(place, reading ? placeText(reading) : "");
      names.forEach((name, index) => {
        const label = rows[index]?.label ?? "";
        setText(name, typeof label === "string" ? label : label(measured()));
      });
      if (reading) values.forEach((value, index) => { setText(value, rows[index]?.value(reading, measured()) ?? ""); });
    },
  };
}

function placeText({ region: { x, y, width, height } }: Reading): string {
  return width * height === 1 ? `${x}, ${y}` : `${x}, ${y}, ${width} × ${height}`;
}

/** Of what saw nothing, how rare light is: with 95 %, fewer than 3 in n samples meet any (Hanley and Lippman-Hand 1983). */
function errorText({ standardError, xyz, samples: [fewest], pixels }: Reading): string {
  if (xyz[1] <= 0) return fewest * pixels > 3 ? `light in fewer than 1 of ${formatCount((fewest * pixels) / 3)} samples (95\u00a0%)` : "–";
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
