/** The chart of error against time or samples: log-log, with the 1/sqrt(N) line. */
import type uPlot from "uplot";
import { formatCount, formatDuration, formatRelativeError } from "../format.ts";
import { Plot, type Style } from "../plot.ts";
import type { Abscissa } from "./points.ts";
import { logarithmicScale } from "./ticks.ts";

const height_px = 240;
/** More dots than this run into each other. */
const mostDots = 40;
/** A phone has room for seven labels. */
const decadesWithAllLabels = 2.2;

export interface Line {
  label: string;
  values: (number | null)[];
  /** A custom property of the style sheet. */
  colour: string;
  kind: "points" | "line" | "dashed" | "edge";
}

/** Lines over one axis; between two that are edges the ground is tinted. */
export interface Drawing {
  x: number[];
  lines: Line[];
}

export class ConvergenceChart {
  readonly #plot: Plot;
  #drawing: Drawing = { x: [], lines: [] };
  #abscissa: Abscissa = "time";

  constructor(container: HTMLElement) {
    // Without a cursor the legend says how things stand now.
    this.#plot = new Plot(container, (plot) => {
      if (plot.cursor.idx == null) plot.setLegend({ idx: (plot.data[1] ?? []).findLastIndex((value) => value != null) });
    });
  }

  show(drawing: Drawing, abscissa: Abscissa): void {
    const names = (of: Drawing): string => of.lines.map((line) => line.label).join();
    const same = abscissa === this.#abscissa && names(drawing) === names(this.#drawing);
    this.#drawing = drawing;
    this.#abscissa = abscissa;
    if (same && this.#plot.update(dataOf(drawing))) return;
    this.#plot.show(drawing.x.length > 0 ? (style) => [dataOf(this.#drawing), options(this.#drawing, this.#abscissa, style)] : undefined);
  }

  close(): void {
    this.#plot.close();
  }
}

function dataOf({ x, lines }: Drawing): uPlot.AlignedData {
  return [x, ...lines.map((line) => line.values)];
}

function options(drawing: Drawing, abscissa: Abscissa, style: Style): Omit<uPlot.Options, "width"> {
  const formatX = abscissa === "time" ? formatDuration : formatCount;
  const axis = { ...style.axis, filter: all };
  return {
    height: height_px,
    padding: [8, 28, 0, 0],
    scales: { x: logarithmicScale(), y: logarithmicScale() },
    axes: [
      { ...axis, size: 34, space: 60, values: labels(abscissa === "time" ? tickSeconds : formatCount) },
      { ...axis, size: 58, values: labels(tickPercent) },
    ],
    series: [
      { label: abscissa === "time" ? "Time" : "Samples per pixel", value: (_, x: number | null) => text(x, formatX) },
      ...drawing.lines.map((line) => series(line, style.colour(line.colour))),
    ],
    bands: bands(drawing, style.colour("--accent")),
  };
}

function series({ label, kind }: Line, stroke: string): uPlot.Series {
  const common: uPlot.Series = { label, stroke, spanGaps: kind === "points", value: (_, error: number | null) => text(error, formatRelativeError) };
  switch (kind) {
    case "points":
      return { ...common, width: 2, points: { show: (plot) => plot.data[0].length <= mostDots, size: 5, fill: stroke } };
    case "line":
      return { ...common, width: 1.5, points: { show: false } };
    case "dashed":
      return { ...common, width: 1, dash: [6, 4], points: { show: false } };
    case "edge":
      return { ...common, width: 0, points: { show: false }, class: "edge" };
  }
}

function bands({ lines }: Drawing, colour: string): uPlot.Band[] {
  const edges = lines.flatMap(({ kind }, index) => (kind === "edge" ? [index + 1] : []));
  const [high, low] = edges;
  return high !== undefined && low !== undefined ? [{ series: [high, low], fill: `${colour}30` }] : [];
}

/** Labels 1, 2 and 5 of each decade, or where there are many decades their beginnings; uPlot offers all nine and hides what is null. */
function labels(format: (value: number) => string) {
  return (_plot: uPlot, values: number[]): (string | null)[] => {
    const digits = Math.log10((values.at(-1) ?? 1) / (values[0] ?? 1)) > decadesWithAllLabels ? [1] : [1, 2, 5];
    return values.map((value) => (digits.includes(firstDigit(value)) ? format(value) : null));
  };
}

/** Instead of uPlot's own choice of labels. */
function all(_plot: uPlot, values: number[]): number[] {
  return values;
}

/** Few digits and one unit: ticks must stay short. */
function tickSeconds(seconds: number): string {
  return `${seconds.toLocaleString("en", { maximumSignificantDigits: 1 })} s`;
}

function tickPercent(error: number): string {
  return `${(100 * error).toLocaleString("en", { maximumSignificantDigits: 1 })} %`;
}

function firstDigit(value: number): number {
  return Math.round(value / 10 ** Math.floor(Math.log10(value) + 1e-9));
}

function text(value: number | null, format: (value: number) => string): string {
  return value === null ? "–" : format(value);
}
