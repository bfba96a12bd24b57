/** A histogram, or the values along a line with a band of one standard error. */
import uPlot from "uplot";
import { formatValue } from "../format.ts";
import type { Drawing, Style } from "../plot.ts";
import type { Measurement } from "../service/types.ts";

const height_px = 170;

/** What is drawn, and what its values are. */
export interface Charted {
  measured: Measurement;
  /** With its unit. */
  quantity: string;
}

export function chartOf(charted: Charted): (style: Style) => Drawing {
  return (style) => (charted.measured.outline.kind === "line" ? profile(charted, style) : histogram(charted, style));
}

function profile({ measured, quantity }: Charted, style: Style): Drawing {
  const accent = style.colour("--accent");
  const [first] = measured.profile;
  const x = measured.profile.map((pixel) => Math.hypot(pixel.x - (first?.x ?? 0), pixel.y - (first?.y ?? 0)));
  const beside = (sign: number): number[] => measured.profile.map(({ value, standard_error }) => value + sign * (standard_error ?? 0));
  const edge = { stroke: accent, width: 0, points: { show: false }, class: "edge" };
  return [
    [x, beside(0), beside(1), beside(-1)],
    {
      ...frame(style),
      scales: { x: { time: false } },
      series: [
        { label: "Pixels along the line", value: number },
        { label: quantity, stroke: accent, width: 1.5, points: { show: false }, value: number },
        { label: "+σ", ...edge },
        { label: "−σ", ...edge },
      ],
      bands: [{ series: [2, 3], fill: `${accent}30` }],
    },
  ];
}

function histogram({ measured, quantity }: Charted, style: Style): Drawing {
  const accent = style.colour("--accent");
  const { edges, counts } = measured.histogram ?? { edges: [], counts: [] };
  const steps = uPlot.paths.stepped?.({ align: 1 });
  return [
    [edges, [...counts, counts.at(-1) ?? 0]],
    {
      ...frame(style),
      scales: { x: { time: false }, y: { range: (_plot, _low, high) => [0, 1.1 * (high || 1)] } },
      series: [
        { label: quantity, value: number },
        { label: "Pixels", stroke: accent, fill: `${accent}40`, width: 1.5, points: { show: false }, value: number, ...(steps ? { paths: steps } : {}) },
      ],
    },
  ];
}

function frame(style: Style): Pick<uPlot.Options, "height" | "padding" | "axes"> {
  const axis = { ...style.axis, values: numbers };
  return { height: height_px, padding: [8, 16, 0, 0], axes: [axis, { ...axis, size: 64 }] };
}

function numbers(_: uPlot, values: number[]): string[] {
  return values.map((value) => (Math.abs(value) < 1e5 ? `${Number(formatValue(value, 3))}` : value.toExponential().replace("e+", "e")));
}

function number(_: uPlot, value: number | null): string {
  return value === null ? "–" : `${Number(formatValue(value, 4))}`;
}
