/** Whether the estimate of the error is itself to be trusted, and how far it may be wrong. Pure. */
import type { ConvergencePoint } from "../service/types.ts";

/** Fewer pixels than these carry too much of the error: it is then known to 10 % or worse. */
const fewestPixels = 100;
/** Even noise has a few percent of the variance in the worst 1 % of its pixels. */
const largestShare = 0.5;
/** The error falls as the power -1/2 of the samples; slower than this it is not the error of samples alike. */
const slowestSlope = -0.35;
/** The slope is looked at over the last quarter of the samples' logarithm: from a quarter of them on. */
const slopeSpan = 4;
const fewestPoints = 5;

/**
 * Two standard deviations of the error, relative to it. Its square is a mean over pixels; where n of them carry it, and each one's
 * variance is known about to itself (heavy tails), the mean is known to 1/sqrt(n), and its root to half of that.
 */
export function uncertainty(effectivePixels: number): number {
  return effectivePixels > 0 ? Math.min(1, 1 / Math.sqrt(effectivePixels)) : 0;
}

/** Slope of log error over log samples since a quarter of the samples, by least squares; undefined where there is too little. */
export function slope(points: readonly ConvergencePoint[]): number | undefined {
  const last = points.at(-1);
  if (!last) return undefined;
  const since = points.filter(({ samples, relative_error }) => samples >= last.samples / slopeSpan && relative_error > 0);
  const first = since[0];
  if (!first || since.length < fewestPoints || last.samples < 0.9 * slopeSpan * first.samples) return undefined;
  const x = since.map(({ samples }) => Math.log(samples));
  const y = since.map(({ relative_error }) => Math.log(relative_error));
  const mean = (values: number[]): number => values.reduce((sum, value) => sum + value, 0) / values.length;
  const [mx, my] = [mean(x), mean(y)];
  const products = x.reduce((sum, value, i) => sum + (value - mx) * ((y[i] ?? 0) - my), 0);
  return products / x.reduce((sum, value) => sum + (value - mx) ** 2, 0);
}

/** Why the estimate of the error is not to be trusted, in sentences; none where it is. */
export function doubts(points: readonly ConvergencePoint[], pixels: number): string[] {
  const last = points.at(-1);
  if (!last || last.effective_pixels <= 0) return [];
  const found = [];
  // A film of a few pixels has no more than those.
  if (last.effective_pixels < Math.min(fewestPixels, pixels / 4)) {
    const percent = (100 * uncertainty(last.effective_pixels)).toPrecision(2);
    found.push(`About ${last.effective_pixels.toPrecision(2)} of ${pixels} pixels carry the error, so it is known to ${percent} % only.`);
  }
  if (last.worst_share > largestShare) {
    found.push(`The worst 1 % of the pixels have ${(100 * last.worst_share).toFixed(0)} % of the variance: few and very bright samples, as from caustics or small lamps seen by chance.`);
  }
  const steepness = slope(points);
  if (steepness !== undefined && steepness > slowestSlope) {
    found.push(`The error falls as the power ${steepness.toFixed(2)} of the samples, not −0.5: brighter samples are still being met for the first time, so it is likely too low.`);
  }
  return found;
}
