/** Numbers as people read them. */
import type { LinearPolarisation } from "./service/types.ts";

const prefixes = ["", "k", "M", "G", "T", "P"];

/** Three significant digits with an SI prefix: 1234567 is "1.23 M". */
export function formatCount(value: number): string {
  if (!Number.isFinite(value)) return "–";
  let power = 0;
  let scaled = value;
  // 999.5 would round to "1000".
  while (scaled >= 999.5 && power < prefixes.length - 1) {
    scaled /= 1000;
    power += 1;
  }
  const text = power === 0 && Number.isInteger(value) ? `${value}` : significant(scaled, 3);
  return power === 0 ? text : `${text}\u00a0${prefixes[power] ?? ""}`;
}

/** A measured number with some significant digits, as people write it: 0.01234, 12.34, 1.234e7. */
export function formatValue(value: number, digits = 5): string {
  if (!Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e7)) return value.toExponential(digits - 1).replace("e+", "e");
  return size < 10 ** (digits - 1) ? value.toPrecision(digits) : `${Number(value.toPrecision(digits))}`;
}

/** Half of a 95 % interval, after the value that it is of: what ± says everywhere. */
export function plusMinus(standardError: number, digits = 2): string {
  return `±\u00a0${formatValue(1.96 * standardError, digits)}`;
}

/** A relative error as percent with two significant digits; 0 means unknown. */
export function formatRelativeError(value: number): string {
  return value > 0 && Number.isFinite(value) ? `${significant(100 * value, 2)}\u00a0%` : "–";
}

/** Mean samples per pixel: whole where it is whole. */
export function formatSamples(value: number): string {
  return value >= 100 || Number.isInteger(value) ? Math.floor(value).toLocaleString("en") : value.toFixed(1);
}

/** Seconds as "0.8 s", "42 s", "3 min 05 s", "2 h 07 min". */
export function formatDuration(seconds: number): string {
  if (seconds < 10) return `${seconds.toFixed(1)}\u00a0s`;
  const whole = Math.floor(seconds);
  if (whole < 60) return `${whole}\u00a0s`;
  if (whole < 3600) return `${Math.floor(whole / 60)}\u00a0min ${twoDigits(whole % 60)}\u00a0s`;
  return `${Math.floor(whole / 3600)}\u00a0h ${twoDigits(Math.floor((whole % 3600) / 60))}\u00a0min`;
}

/** A unit in ASCII with its signs. */
export function shownUnit(unit: string): string {
  return unit
    .replace("m2", "m²")
    .replace("umol", "µmol")
    .replaceAll(/-[12]/g, (power) => (power === "-1" ? "⁻¹" : "⁻²"));
}

/** "0.60 EUR"; what is below a hundredth is not said to be nothing. */
export function formatMoney(amount: number, currency: string): string {
  const text = amount >= 0.01 || amount === 0 ? amount.toLocaleString("en", { minimumFractionDigits: 2, maximumFractionDigits: 2 }) : amount.toPrecision(2);
  return `${text}\u00a0${currency}`;
}

/** Words between commas, each once. */
export function wordsOf(text: string): string[] {
  return [...new Set(text.split(",").map((word) => word.trim()).filter(Boolean))];
}

/** An exposure with its sign: "+1.5 EV". */
export function formatStops(stops: number): string {
  const sign = stops > 0 ? "+" : stops < 0 ? "−" : "";
  return `${sign}${Math.abs(stops).toFixed(1)}\u00a0EV`;
}

/** "STOPPED_EARLY" is "Stopped early". */
export function formatState(state: string): string {
  return state.charAt(0) + state.slice(1).toLowerCase().replaceAll("_", " ");
}

function significant(value: number, digits: number): string {
  if (value === 0) return "0";
  // Rounded first: 9.997 has the decimals of 10.0.
  const rounded = Number(value.toPrecision(digits));
  const decimals = Math.max(0, digits - 1 - Math.floor(Math.log10(Math.abs(rounded))));
  return rounded.toFixed(Math.min(decimals, 20));
}

function twoDigits(value: number): string {
  return value.toString().padStart(2, "0");
}

/** Degree with its interval, and angle from the sensor's right towards up. */
export function polarisationText({ degree, degree_interval: ends, angle_degrees: angle, angle_error: error }: LinearPolarisation): string {
  const interval = ends.length === 2 ? ` (${ends.map((end) => formatValue(end, 3)).join(" to ")})` : "";
  return `${formatValue(degree, 3)}${interval}, at ${angle.toFixed(1)}°${error === null ? "" : ` ± ${formatValue(error, 2)}°`}`;
}
