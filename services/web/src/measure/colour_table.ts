/** Table of a measured part: daylight factor, places, the colour of its light, and how that is polarised. */
import { table, tableRow } from "../dom.ts";
import { formatValue, plusMinus, polarisationText } from "../format.ts";
import { capital } from "../image/look.ts";
import type { Measurement } from "../service/types.ts";

/** Empty where nothing is known. */
export function tellsOf({ colour, daylight_factor: daylight, linear_polarisation: polarised, minimum, maximum }: Measurement): HTMLElement[] {
  const rows = colour.map(({ name, value, standard_error: error, unit }) =>
    row(capital(name), value === null ? "–" : `${withError(value, error)} ${unit.replace("m-2", "m⁻²").replace("m2", "m²")}`));
  if (polarised) rows.push(row("Linearly polarised", polarisationText(polarised)));
  if (daylight) {
    rows.unshift(
      row("Daylight factor", `${withError(daylight.mean, daylight.mean_error)} %`),
      row("Least daylight factor", `${withError(daylight.minimum, daylight.minimum_error)} %`),
    );
  }
  if (minimum.place && maximum.place) {
    rows.unshift(row("Darkest at", placeText(minimum.place)), row("Brightest at", placeText(maximum.place)));
  }
  if (rows.length === 0) return [];
  return [table([], rows, "Of the light that arrives; after ±: half of the 95 % interval")];
}

/** x, y, z in metres, to the millimetre. */
function placeText(place: readonly number[]): string {
  return `${place.map((value) => `${Number(value.toFixed(3))}`).join(", ")} m`;
}

function row(name: string, value: string): HTMLElement {
  return tableRow(name, [value.trim()]);
}

function withError(value: number, error: number | null): string {
  return error === null ? formatValue(value, 5) : `${formatValue(value, 5)} ${plusMinus(error)}`;
}
