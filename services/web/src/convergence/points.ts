/** The error history as a curve: cleaning, thinning and the 1/sqrt(N) line. Pure. */
import type { ErrorPoint } from "../service/types.ts";

export type Abscissa = "time" | "photons";

export interface Curve {
  x: number[];
  error: number[];
  /** The error that falls as 1/sqrt(x) through the middle of the points. */
  guide: number[];
}

/** More points than a chart has columns cannot be seen. */
const pointsShown = 300;

/** The history with one more point, unless it says nothing new. */
export function appended(points: readonly ErrorPoint[], point: ErrorPoint): readonly ErrorPoint[] {
  const last = points.at(-1);
  if (point.relative_error <= 0 || point.time_s <= 0) return points;
  if (last && (point.photons <= last.photons || point.time_s <= last.time_s)) return points;
  return [...points, point];
}

/** What is drawn: positive, growing abscissae, evenly spread over a logarithmic axis. */
export function toCurve(points: readonly ErrorPoint[], abscissa: Abscissa): Curve {
  const usable = growing(
    points.map((point) => ({ x: abscissa === "time" ? point.time_s : point.photons, error: point.relative_error })),
  );
  const shown = thinned(usable);
  const constant = median(shown.map((point) => point.error * Math.sqrt(point.x)));
  return {
    x: shown.map((point) => point.x),
    error: shown.map((point) => point.error),
    guide: shown.map((point) => constant / Math.sqrt(point.x)),
  };
}

interface Sample {
  x: number;
  error: number;
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
