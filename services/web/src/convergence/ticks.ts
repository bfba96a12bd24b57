/** Logarithmic axes and their ends. Pure. */
import type uPlot from "uplot";

// The declarations name it in a const enum, which single-file compilers cannot read.
// eslint-disable-next-line @typescript-eslint/no-unsafe-enum-assignment
const logarithmic = 3 as uPlot.Scale.Distr;

/** Of any chart with logarithmic axes; `margin`: factor by which it is wider than its data at each end. */
export function logarithmicScale(margin = 1): uPlot.Scale {
  return { time: false, distr: logarithmic, range: (_plot, low, high) => wholeTicks(low, high, margin) };
}

/**
 * Widens a range to the next 1, 2 or 5 times a power of ten, so that even a short history has labelled ends.
 * uPlot needs it, too: from other beginnings, such as 0.00098, its steps never come to an end.
 */
export function wholeTicks(low: number | null, high: number | null, margin = 1): [number, number] {
  return [roundTick((low ?? 0.1) / margin, Math.floor), roundTick((high ?? 1) * margin, Math.ceil)];
}

function roundTick(value: number, round: (value: number) => number): number {
  const decade = 10 ** Math.floor(Math.log10(value));
  const ticks = [1, 2, 5, 10];
  const place = ticks.findIndex((tick) => tick * decade > value * (1 + 1e-9));
  const above = Math.max(1, place);
  const exact = Math.abs((ticks[above - 1] ?? 1) * decade - value) < 1e-9 * value;
  return (exact || round === Math.floor ? (ticks[above - 1] ?? 1) : (ticks[above] ?? 10)) * decade;
}
