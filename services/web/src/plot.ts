/** A chart as wide as its container, in the colours of the page. */
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";

export interface Style {
  /** The value of a custom property of the style sheet. */
  colour: (name: string) => string;
  axis: uPlot.Axis;
}

export type Drawing = [data: uPlot.AlignedData, options: Omit<uPlot.Options, "width">];

export class Plot {
  readonly #container: HTMLElement;
  readonly #shown: (plot: uPlot) => void;
  readonly #observer = new ResizeObserver(() => { this.#plot?.setSize({ width: this.#width(), height: this.#plot.height }); });
  // A canvas does not follow style sheets: new colours need a new plot.
  readonly #theme = window.matchMedia("(prefers-color-scheme: dark)");
  readonly #redraw = (): void => { this.show(this.#draw); };
  #draw: ((style: Style) => Drawing) | undefined;
  #plot: uPlot | undefined;

  /** `shown` is called after each drawing. */
  constructor(container: HTMLElement, shown: (plot: uPlot) => void = () => undefined) {
    this.#container = container;
    this.#shown = shown;
    this.#observer.observe(container);
    this.#theme.addEventListener("change", this.#redraw);
  }

  /** Draws anew, also when the colours change; undefined: nothing. */
  show(draw: ((style: Style) => Drawing) | undefined): void {
    this.#draw = draw;
    this.#plot?.destroy();
    this.#plot = undefined;
    if (!draw) return;
    const styles = getComputedStyle(document.documentElement);
    const colour = (name: string): string => styles.getPropertyValue(name).trim();
    const [data, options] = draw({ colour, axis: { stroke: colour("--muted"), grid: { stroke: colour("--line"), width: 1 }, ticks: { show: false } } });
    this.#plot = new uPlot({ ...options, width: this.#width() }, data, this.#container);
    this.#afterwards();
  }

  /** Other values of the same lines; where nothing is drawn yet, false. */
  update(data: uPlot.AlignedData): boolean {
    this.#plot?.setData(data);
    this.#afterwards();
    return this.#plot !== undefined;
  }

  close(): void {
    this.#observer.disconnect();
    this.#theme.removeEventListener("change", this.#redraw);
    this.#plot?.destroy();
  }

  /** uPlot empties the legend when it commits, in a separate microtask. */
  #afterwards(): void {
    queueMicrotask(() => { if (this.#plot) this.#shown(this.#plot); });
  }

  #width(): number {
    return Math.max(200, this.#container.clientWidth);
  }
}
