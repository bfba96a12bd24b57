/** The error history as curves: cleaning, thinning, the 1/sqrt(N) line, and what is to come. Pure. */
import type { ConvergencePoint } from "../service/types.ts";
import { uncertainty } from "./trust.ts";

export type Abscissa = "time" | "samples";

type Column = (number | null)[];

/** Columns of equal length; null where a curve has no point. */
export interface Curve {
  x: number[];
  error: Column;
  /** The error that falls as 1/sqrt(x) through the middle of the points. */
  guide: Column;
  /** What was asked for. */
  target: Column;
  /** From the last point on, with two standard deviations around it. */
  prediction: Column;
  low: Column;
  high: Column;
}

/** What is asked of a render, and where it stands; 0 where it is not asked for. */
export interface Aim {
  relativeError: number;
  samples: number;
}

/** More points than a chart has columns cannot be seen. */
const pointsShown = 300;
const pointsAhead = 16;
/** A goal further away than this would press the history against the edge. */
const furthestAhead = 100;

/** The history with one more point, unless it says nothing new. */
export function appended(points: readonly ConvergencePoint[], point: ConvergencePoint): readonly ConvergencePoint[] {
  const last = points.at(-1);
  if (point.relative_error <= 0 || point.time_s <= 0) return points;
  if (last && (point.samples <= last.samples || point.time_s <= last.time_s)) return points;
  return [...points, point];
}

/** What is drawn: positive, growing abscissae, evenly spread over a logarithmic axis; `aim` while it goes on. */
export function toCurve(points: readonly ConvergencePoint[], abscissa: Abscissa, aim?: Aim): Curve {
  const shown = usable(points, abscissa);
  const constant = median(shown.map((point) => point.error * Math.sqrt(point.x)));
  const ahead = aim ? whatComes(shown.at(-1), points.at(-1), aim) : [];
  const x = [...shown.map((point) => point.x), ...ahead.map((point) => point.x)];
  const nothing = ahead.map(() => null);
  const before = Array.from({ length: Math.max(0, shown.length - 1) }, () => null);
  const joined = (choose: (point: Ahead) => number): Column => {
    const last = shown.at(-1);
    return ahead.length > 0 && last ? [...before, last.error, ...ahead.map(choose)] : shown.map(() => null);
  };
  return {
    x,
    error: [...shown.map((point) => point.error), ...nothing],
    guide: x.map((value) => constant / Math.sqrt(value)),
    target: x.map(() => (aim && aim.relativeError > 0 ? aim.relativeError : null)),
    prediction: joined((point) => point.error),
    low: joined((point) => point.low),
    high: joined((point) => point.high),
  };
}

export interface Sample {
  x: number;
  error: number;
}

/** The points that can be drawn, over time or samples. */
export function usable(points: readonly ConvergencePoint[], abscissa: Abscissa): Sample[] {
  return thinned(growing(points.map((point) => ({ x: abscissa === "time" ? point.time_s : point.samples, error: point.relative_error }))));
}

interface Ahead extends Sample {
  low: number;
  high: number;
}

/** From the last point to the first goal, along 1/sqrt(N). */
function whatComes(last: Sample | undefined, point: ConvergencePoint | undefined, aim: Aim): Ahead[] {
  if (!last || !point) return [];
  const goals = [point.samples > 0 ? aim.samples / point.samples : 1];
  if (aim.relativeError > 0) goals.push((last.error / aim.relativeError) ** 2);
  const factor = Math.min(furthestAhead, ...goals);
  if (factor <= 1.02) return [];
  const spread = uncertainty(point.effective_pixels);
  return Array.from({ length: pointsAhead }, (_, step) => {
    const growth = factor ** ((step + 1) / pointsAhead);
    const error = last.error / Math.sqrt(growth);
    return { x: last.x * growth, error, low: error * Math.max(0.1, 1 - spread), high: error * (1 + spread) };
  });
}

function growing(samples: Sample[]): Sample[] {
  let last = 0;
  return samples.filter(({ x, error }) => {
    if (x <= last || error <= 0) return false;
    last = x;
    return true;
  });
}

/** First, last and what is a step of the logarithmic axis after the one before. */
function thinned(samples: Sample[]): Sample[] {
  const first = samples[0];
  const last = samples.at(-1);
  if (!first || !last || samples.length <= pointsShown) return samples;
  const step = (last.x / first.x) ** (1 / pointsShown);
  let next = 0;
  return samples.filter((sample) => {
    if (sample.x < next && sample !== last) return false;
    next = sample.x * step;
    return true;
  });
}

/** Middle value; robust against the first, noisy estimates of the error. */
function median(values: number[]): number {
  const sorted = values.toSorted((a, b) => a - b);
  return sorted[Math.floor(sorted.length / 2)] ?? 0;
}

/** Two histories over one axis, for a comparison. */
export function together(first: Sample[], second: Sample[]): { x: number[]; first: Column; second: Column } {
  const x = [...new Set([...first, ...second].map((sample) => sample.x))].sort((a, b) => a - b);
  const at = (samples: Sample[]): Column => {
    const known = new Map(samples.map((sample) => [sample.x, sample.error]));
    return x.map((value) => known.get(value) ?? null);
  };
  return { x, first: at(first), second: at(second) };
}
