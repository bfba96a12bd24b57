/** A histogram, or the values along a line with a band of one standard error. */
import uPlot from "uplot";
import { formatValue } from "../format.ts";
import type { Measurement } from "../service/types.ts";

const height_px = 170;

type Drawing = [uPlot.AlignedData, Omit<uPlot.Options, "width" | "height">];

/** What is drawn, and what its values are. */
export interface Charted {
  measured: Measurement;
  /** With its unit. */
  quantity: string;
}

export class MeasureChart {
  readonly #container: HTMLElement;
  readonly #observer: ResizeObserver;
  readonly #theme = window.matchMedia("(prefers-color-scheme: dark)");
  readonly #redraw = (): void => { this.#draw(); };
  #charted: Charted | undefined;
  #plot: uPlot | undefined;

  constructor(container: HTMLElement) {
    this.#container = container;
    this.#observer = new ResizeObserver(() => { this.#plot?.setSize({ width: this.#width(), height: height_px }); });
    this.#observer.observe(container);
    // A canvas does not follow style sheets: new colours need a new plot.
    this.#theme.addEventListener("change", this.#redraw);
  }

  show(charted: Charted): void {
    this.#charted = charted;
    this.#draw();
  }

  close(): void {
    this.#observer.disconnect();
    this.#theme.removeEventListener("change", this.#redraw);
    this.#plot?.destroy();
  }

  #draw(): void {
    this.#plot?.destroy();
    if (!this.#charted) return;
    const [data, options] = this.#charted.measured.outline.kind === "line" ? profile(this.#charted) : histogram(this.#charted);
    this.#plot = new uPlot({ width: this.#width(), height: height_px, padding: [8, 16, 0, 0], ...options }, data, this.#container);
  }

  #width(): number {
    return Math.max(200, this.#container.clientWidth);
  }
}

function profile({ measured, quantity }: Charted): Drawing {
  const { axes, accent } = style();
  const [first] = measured.profile;
  const x = measured.profile.map((pixel) => Math.hypot(pixel.x - (first?.x ?? 0), pixel.y - (first?.y ?? 0)));
  const beside = (sign: number): number[] => measured.profile.map(({ value, standard_error }) => value + sign * (standard_error ?? 0));
  const edge = { stroke: accent, width: 0, points: { show: false }, class: "edge" };
  return [
    [x, beside(0), beside(1), beside(-1)],
    {
      scales: { x: { time: false } },
      axes,
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

function histogram({ measured, quantity }: Charted): Drawing {
  const { axes, accent } = style();
  const { edges, counts } = measured.histogram ?? { edges: [], counts: [] };
  const steps = uPlot.paths.stepped?.({ align: 1 });
  return [
    [edges, [...counts, counts.at(-1) ?? 0]],
    {
      scales: { x: { time: false }, y: { range: (_plot, _low, high) => [0, 1.1 * (high || 1)] } },
      axes,
      series: [
        { label: quantity, value: number },
        { label: "Pixels", stroke: accent, fill: `${accent}40`, width: 1.5, points: { show: false }, value: number, ...(steps ? { paths: steps } : {}) },
      ],
    },
  ];
}

function style(): { axes: uPlot.Axis[]; accent: string } {
  const styles = getComputedStyle(document.documentElement);
  const colour = (name: string): string => styles.getPropertyValue(name).trim();
  const axis = { stroke: colour("--muted"), grid: { stroke: colour("--line"), width: 1 }, ticks: { show: false }, values: numbers };
  return { axes: [axis, { ...axis, size: 64 }], accent: colour("--accent") };
}

function numbers(_: uPlot, values: number[]): string[] {
  return values.map((value) => (Math.abs(value) < 1e5 ? `${Number(formatValue(value, 3))}` : value.toExponential().replace("e+", "e")));
}

function number(_: uPlot, value: number | null): string {
  return value === null ? "–" : `${Number(formatValue(value, 4))}`;
}
