/** Speed against accuracy: what the benches drew, and each render of this service as a point on the same plane. */
import uPlot from "uplot";
import { element } from "../dom.ts";
import { formatDuration, formatRelativeError } from "../format.ts";
import { renderRoute } from "../router.ts";
import type { Renders } from "../service/renders.ts";
import { hasImage, type Render } from "../service/types.ts";
import type { View } from "./view.ts";

/** Charts of `make bench`, as they are in the repository when the page is built. */
const charts = import.meta.glob<string>("../../../../bench/results/*.svg", { query: "?url", import: "default", eager: true });

// The declarations name it in a const enum, which single-file compilers cannot read.
// eslint-disable-next-line @typescript-eslint/no-unsafe-enum-assignment
const logarithmic = 3 as uPlot.Scale.Distr;

export function speedView(renders: Renders): View {
  const container = element("div", { class: "plot" });
  const table = element("div", { class: "events" });
  const about = "Processor time of workers and relative error of each render; further down and further left is better. Along a dashed line four times the time halves the error.";
  const node = element(
    "div",
    {},
    element("h1", { tabindex: "-1" }, "Speed against accuracy"),
    element("section", { "aria-labelledby": "points-title" }, element("h2", { id: "points-title" }, "Renders of this service"), element("p", { class: "note" }, about), container, table),
    element("section", { "aria-labelledby": "bench-title" }, element("h2", { id: "bench-title" }, "Benches"), ...benchCharts()),
  );
  let plot: uPlot | undefined;
  let drawn = "";
  const draw = (): void => {
    const measured = renders.newestFirst().filter((render) => hasImage(render) && render.progress.relative_error > 0 && render.progress.cpu_seconds > 0);
    const key = measured.map((render) => `${render.id}${render.sequence}`).join();
    if (key === drawn) return;
    drawn = key;
    plot?.destroy();
    plot = measured.length > 0 ? scatter(measured, container) : undefined;
    table.replaceChildren(tableOf(measured));
  };
  const unsubscribe = renders.subscribe(draw);
  // After the node has its width.
  requestAnimationFrame(draw);
  return {
    node,
    title: "Speed",
    close: () => {
      unsubscribe();
      plot?.destroy();
    },
  };
}

function scatter(renders: Render[], container: HTMLElement): uPlot {
  const styles = getComputedStyle(document.documentElement);
  const colour = (name: string): string => styles.getPropertyValue(name).trim();
  const sorted = renders.toSorted((a, b) => a.progress.cpu_seconds - b.progress.cpu_seconds);
  const x = sorted.map((render) => render.progress.cpu_seconds);
  const y = sorted.map((render) => render.progress.relative_error);
  const constant = (y[0] ?? 1) * Math.sqrt(x[0] ?? 1);
  const axis = { stroke: colour("--muted"), grid: { stroke: colour("--line"), width: 1 }, ticks: { show: false } };
  const wide = (_: uPlot, low: number | null, high: number | null): [number, number] => [(low ?? 0.1) / 2, (high ?? 1) * 2];
  return new uPlot(
    {
      width: Math.max(260, container.clientWidth),
      height: 280,
      legend: { show: false },
      scales: { x: { time: false, distr: logarithmic, range: wide }, y: { distr: logarithmic, range: wide } },
      axes: [
        { ...axis, values: (_, values) => values.map((value) => (value ? formatDuration(value) : null)) },
        { ...axis, size: 64, values: (_, values) => values.map((value) => (value ? formatRelativeError(value) : null)) },
      ],
      series: [
        {},
        { label: "Relative error", stroke: colour("--accent"), paths: () => null, points: { show: true, size: 9, fill: colour("--accent") } },
        { label: "1/√time", stroke: colour("--muted"), dash: [6, 4], points: { show: false } },
      ],
    },
    [x, y, x.map((value) => constant / Math.sqrt(value))],
    container,
  );
}

/** Efficiency: 1 / (error² × time), which does not change while a render goes on as 1/√N. */
function tableOf(renders: Render[]): HTMLElement {
  if (renders.length === 0) return element("p", { class: "muted" }, "No render has an error yet.");
  const head = element("tr", {}, ...["Render", "CPU time", "Relative error", "1 / (error² × s)"].map((text) => element("th", { scope: "col" }, text)));
  const rows = renders.map(({ id, name, progress }) => {
    const efficiency = 1 / (progress.relative_error ** 2 * progress.cpu_seconds);
    const cells = [formatDuration(progress.cpu_seconds), formatRelativeError(progress.relative_error), efficiency.toPrecision(3)];
    return element("tr", {}, element("th", { scope: "row" }, element("a", { href: renderRoute(id) }, name || id)), ...cells.map((text) => element("td", {}, text)));
  });
  return element("table", {}, element("thead", {}, head), element("tbody", {}, ...rows));
}

function benchCharts(): HTMLElement[] {
  const found = Object.entries(charts).map(([path, address]) => {
    const name = (path.split("/").at(-1) ?? "").replace(".svg", "").replaceAll("-", " ");
    return element("figure", { class: "bench" }, element("img", { src: address, alt: `Chart of the bench ${name}`, loading: "lazy" }), element("figcaption", { class: "note" }, name));
  });
  return found.length > 0 ? found : [element("p", { class: "muted" }, "No charts were there when this page was built; `make bench` draws them.")];
}
