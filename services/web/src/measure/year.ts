/** A year of daylight as the service tells it, and what the page shows of it. Pure. */
import { formatValue } from "../format.ts";

/** A figure with its 95 % interval. */
export interface Figure {
  value: number;
  low: number;
  high: number;
}

export interface Point {
  instrument: string;
  place: [number, number, number];
  [figure: string]: Figure | string | [number, number, number];
}

export interface Year {
  weather: string;
  hours: number;
  batches: number;
  samples: number;
  "blinds closed"?: number;
  sDA: Figure;
  ASE: Figure;
  verdicts: { says: string; probability: number }[];
  /** Mean of the points in each hour of the year, lx. */
  hourly: number[];
  means: Record<string, Figure>;
  points: Point[];
  eyes: Point[];
}

/** Of figures; all others are parts, which are told in per cent. */
const units: Record<string, string> = {
  "hours above": "h",
  "sun hours": "h",
  "mean illuminance": "lx",
  "lux hours of the year": "lx h",
  "melanopic EDI": "lx",
};

const hoursOfDay = 24;

function percent(part: number, digits = 1): string {
  return (100 * part).toFixed(digits);
}

/** "sDA 55.2 % (52.1 to 56.2)". */
export function shareText(name: string, { value, low, high }: Figure): string {
  return `${name} ${percent(value)}\u00a0% (${percent(low)} to ${percent(high)})`;
}

/** The least certain of a probability is told as such: never 0 or 1. */
export function probabilityText(probability: number): string {
  if (probability > 0.995) return "> 0.99";
  if (probability < 0.005) return "< 0.01";
  return `= ${probability.toFixed(2)}`;
}

/** "P(sDA ≥ 55 %) = 0.41". */
export function verdictText({ says, probability }: Year["verdicts"][number]): string {
  return `P(${says.replace(">=", "≥").replace("<=", "≤").replace("%", "\u00a0%")}) ${probabilityText(probability)}`;
}

/** The value with half of its interval. */
export function figureText(name: string, { value, high }: Figure): string {
  const unit = units[name];
  if (unit === undefined) return `${percent(value, 2)} ±\u00a0${percent(high - value, 2)}\u00a0%`;
  return `${formatValue(value, 4)} ±\u00a0${formatValue(high - value, 2)}\u00a0${unit}`;
}

/** For a plan, where there is room for few letters. */
export function shortText(name: string, value: number): string {
  return units[name] === undefined ? (100 * value).toFixed(0) : `${Number(value.toPrecision(3))}`;
}

export function unitOf(name: string): string {
  return units[name] ?? "%";
}

/** The names of figures that points have, in their order. */
export function figureNames({ points }: Pick<Year, "points">): string[] {
  const [first] = points;
  return first ? Object.keys(first).filter((name) => name !== "instrument" && name !== "place") : [];
}

export function valueOf(point: Point, name: string): number {
  const figure = point[name];
  return typeof figure === "object" && "value" in figure ? figure.value : Number.NaN;
}

export interface Plan {
  instrument: string;
  columns: number;
  points: readonly Point[];
}

/** Points by instrument, as in its plan: a row ends where the next point is not one step further. */
export function plansOf({ points, eyes }: Pick<Year, "points" | "eyes">): Plan[] {
  const notOfRoom = new Set(eyes.map(({ instrument }) => instrument));
  const names = [...new Set(points.map(({ instrument }) => instrument))].filter((name) => !notOfRoom.has(name));
  return names.map((instrument) => {
    const own = points.filter((point) => point.instrument === instrument);
    return { instrument, columns: columnsOf(own), points: own };
  });
}

function columnsOf(points: readonly Point[]): number {
  const [first, second] = points;
  if (!first || !second) return Math.max(1, points.length);
  const step = (a: Point, b: Point): number[] => b.place.map((value, axis) => value - (a.place[axis] ?? 0));
  const across = step(first, second);
  const size = Math.hypot(...across);
  const isNext = (a: Point, b: Point): boolean => Math.hypot(...step(a, b).map((value, axis) => value - (across[axis] ?? 0))) < 1e-6 * Math.max(1, size);
  for (let index = 2; index < points.length; index += 1) {
    const [before, here] = [points[index - 1], points[index]];
    if (before && here && !isNext(before, here)) return index;
  }
  return points.length;
}

/** Counts of points in even steps from the least to the greatest value. */
export function histogramOf(values: readonly number[], bins: number): { edges: number[]; counts: number[] } {
  const low = Math.min(...values);
  const high = Math.max(...values);
  const width = (high - low) / bins || 1;
  const counts = Array.from({ length: bins }, () => 0);
  for (const value of values) {
    const bin = Math.min(bins - 1, Math.floor((value - low) / width));
    counts[bin] = (counts[bin] ?? 0) + 1;
  }
  return { edges: Array.from({ length: bins + 1 }, (_, index) => low + index * width), counts };
}

/** Steps of illuminance that the map of the year has a colour for, lx. */
export const steps = [50, 100, 200, 300, 500, 750, 1000, 2000, 5000];

/** In which step a value is, 0 to their number. */
export function stepOf(value: number): number {
  return steps.filter((step) => value >= step).length;
}

/** Days of the year, and by day and hour its illuminance: `hourly` begins with the first hour of January 1st. */
export function daysIn(hourly: readonly number[]): number {
  return Math.floor(hourly.length / hoursOfDay);
}

const monthDays = [31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
export const months = ["January", "February", "March", "April", "May", "June", "July", "August", "September", "October", "November", "December"];

/** The first day of each month, from 0; of a leap year, too. */
export function monthStarts(days: number): number[] {
  const starts = [];
  let day = 0;
  for (const [month, length] of monthDays.entries()) {
    starts.push(day);
    day += month === 1 && days === 366 ? length + 1 : length;
  }
  return starts;
}

/** Of each month the mean illuminance from `first` to `last` o'clock, for those who do not see the map. */
export function monthlyMeans(hourly: readonly number[], first: number, last: number): number[] {
  const days = daysIn(hourly);
  const starts = [...monthStarts(days), days];
  return months.map((_, month) => {
    const found = [];
    for (let day = starts[month] ?? 0; day < (starts[month + 1] ?? 0); day += 1) {
      for (let hour = 0; hour < hoursOfDay; hour += 1) {
        const middle = hour + 0.5;
        if (middle > first && middle < last) found.push(hourly[day * hoursOfDay + hour] ?? 0);
      }
    }
    return found.reduce((sum, value) => sum + value, 0) / Math.max(1, found.length);
  });
}
