/** Numbers of the inspector as text: those that the film has at once, with the errors that the service tells. Pure. */
import type { Reading } from "../image/tiled_image.ts";
import { chromaticity, colourTemperature, distanceFromLocus } from "../image/colour.ts";
import { formatCount, formatValue, plusMinus, polarisationText } from "../format.ts";
import { capital, type Measured } from "../image/look.ts";
import type { RegionReading } from "../service/types.ts";

export interface Row {
  name: string;
  text: string;
}

/**
 * `told`: what the service says of the same region; undefined as long as it has not answered. `isAsked`: whether it
 * will; if not, errors are those of independent pixels.
 */
export function rowsOf(reading: Reading, told: RegionReading | undefined, isAsked: boolean, { quantity, unit }: Measured): Row[] {
  const y = told?.values[1]?.mean ?? reading.xyz[1];
  const [fewest, most] = reading.samples;
  return [
    { name: capital(quantity), text: y > 0 ? `${formatValue(y)}\u00a0${unit}`.trimEnd() : "nothing seen" },
    { name: "95\u00a0%", text: errorText(reading, told, isAsked) },
    { name: "X Y Z", text: valuesText(reading, told) },
    { name: "u\u2032 v\u2032", text: colourText(reading, told) },
    { name: "x y", text: xyText(reading) },
    { name: "CCT", text: temperatureText(reading) },
    ...(told?.linear_polarisation ? [{ name: "Polarised", text: polarisationText(told.linear_polarisation) }] : []),
    ...(told?.values.slice(3) ?? []).map(({ name, mean, standard_error: error }) => ({ name, text: withError(formatValue(mean), error) })),
    { name: "Samples", text: fewest === most ? formatCount(fewest) : `${formatCount(fewest)}–${formatCount(most)}` },
    { name: "Invalid samples", text: `${formatCount(reading.invalid_samples)} in tile` },
  ];
}

/** Of what saw nothing, how rare light is: with 95 %, fewer than 3 in n samples meet any (Hanley and Lippman-Hand 1983). */
function errorText(reading: Reading, told: RegionReading | undefined, isAsked: boolean): string {
  const { xyz, pixels, samples: [fewest] } = reading;
  if (xyz[1] <= 0) return fewest * pixels > 3 ? `light in fewer than 1 of ${formatCount((fewest * pixels) / 3)} samples (95\u00a0%)` : "–";
  if (!told && isAsked && pixels > 1) return "…";
  const error = told ? told.values[1]?.standard_error : reading.standardError;
  if (typeof error !== "number" || !Number.isFinite(error)) return "–";
  return `${plusMinus(error, 3)} (${formatValue((196 * error) / xyz[1], 2)}\u00a0%)`;
}

function valuesText({ xyz }: Reading, told: RegionReading | undefined): string {
  if (!told) return xyz.map((value) => formatValue(value)).join("  ");
  return told.values.slice(0, 3).map(({ mean, standard_error: error }) => withError(formatValue(mean), error)).join("  ");
}

function colourText({ xyz: [X, Y, Z] }: Reading, told: RegionReading | undefined): string {
  const whole = X + 15 * Y + 3 * Z;
  if (whole <= 0) return "–";
  const u = told?.u_prime ?? (4 * X) / whole;
  const v = told?.v_prime ?? (9 * Y) / whole;
  return `${withError(u.toFixed(4), told?.u_prime_error)}  ${withError(v.toFixed(4), told?.v_prime_error)}`;
}

/** The value with its 95 % interval, where its standard error is known. */
function withError(value: string, error: number | null | undefined): string {
  return typeof error === "number" ? `${value}\u00a0${plusMinus(error)}` : value;
}

function xyText({ xyz }: Reading): string {
  const found = chromaticity(xyz);
  return found ? `${found.x.toFixed(4)}  ${found.y.toFixed(4)}` : "–";
}

function temperatureText({ xyz }: Reading): string {
  const found = chromaticity(xyz);
  const kelvin = found && colourTemperature(found);
  return found && kelvin ? `${Math.round(kelvin)}\u00a0K, Duv ${distanceFromLocus(found).toFixed(4)}` : "–";
}
