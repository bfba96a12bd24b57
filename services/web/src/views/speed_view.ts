/** Speed against accuracy: the error of this service's renders over their processor time; the benches in two charts. */
import type uPlot from "uplot";
import benches from "../../../../bench/results/speed-summary.json";
import { logarithmicScale } from "../convergence/ticks.ts";
import { element, section, table, tableRow } from "../dom.ts";
import { formatDuration, formatRelativeError } from "../format.ts";
import { type Drawing, Plot, type Style } from "../plot.ts";
import { renderRoute } from "../router.ts";
import { getConvergence } from "../service/client.ts";
import type { Renders } from "../service/renders.ts";
import { hasImage, type ConvergencePoint, type Render } from "../service/types.ts";
import { dotTable } from "./dot_table.ts";
import { chosenOf, curvesOf } from "./speed_curves.ts";
import type { View } from "./view.ts";

/** As the style sheet has them; told apart by people who do not see colours alike. */
const lineColours = ["--line-1", "--line-2", "--line-3", "--line-4", "--line-5", "--line-6"];
const mostRows = 30;

/** As bench/suite/page.py writes it; null: not known. */
const summary: readonly { scene: string; default: number | null; ways: readonly number[]; beside_peer: number | null }[] = benches;

export function speedView(renders: Renders): View {
  const container = element("div", { class: "plot" });
  const table = element("div", { class: "events" });
  const chart = new Curves(container);
  let asked = (new URLSearchParams(location.hash.split("?")[1]).get("renders") ?? "").split(",").filter(Boolean);
  let drawn = "";
  const draw = (): void => {
    const measured = renders.newestFirst().filter((render) => hasImage(render) && render.progress.relative_error > 0 && render.progress.cpu_seconds > 0);
    const chosen = chosenOf(measured, asked, lineColours.length);
    const key = `${chosen.map(({ id }) => id).join()} ${measured.map((render) => `${render.id}${render.sequence}`).join()}`;
    if (key === drawn) return;
    drawn = key;
    void chart.show(chosen);
    table.replaceChildren(tableOf(measured.slice(0, mostRows), chosen, choose));
  };
  const choose = (ids: string[]): void => {
    asked = ids.slice(-lineColours.length);
    history.replaceState(null, "", asked.length > 0 ? `#/speed?renders=${asked.join()}` : "#/speed");
    const label = document.activeElement?.getAttribute("aria-label");
    draw();
    if (label) table.querySelector<HTMLElement>(`[aria-label="${CSS.escape(label)}"]`)?.focus();
  };
  const unsubscribe = renders.subscribe(draw);
  const about = "Relative error over the processor time of workers; lower and further left is better. Along a dashed line four times the time halves the error.";
  const node = element(
    "div",
    {},
    element("h1", { tabindex: "-1" }, "Speed against accuracy"),
    section("points", "Renders of this service", element("p", { class: "note" }, about), container, table),
    section("peers", "Compared with Mitsuba 3", peers()),
    section("ways", "Methods of tracing", ways()),
  );
  // After the node has its width.
  requestAnimationFrame(draw);
  return {
    node,
    title: "Speed",
    close: () => {
      unsubscribe();
      chart.close();
    },
  };
}

/** Lines of renders; their histories are asked for once for each state of them. */
class Curves {
  readonly #known = new Map<string, readonly ConvergencePoint[]>();
  readonly #plot: Plot;
  #shown = 0;

  constructor(container: HTMLElement) {
    this.#plot = new Plot(container);
  }

  async show(renders: readonly Render[]): Promise<void> {
    const turn = ++this.#shown;
    const histories = await Promise.all(renders.map((render) => this.#historyOf(render)));
    if (turn !== this.#shown) return;
    this.#plot.show(renders.length > 0 ? (style) => drawingOf(renders, histories, style) : undefined);
  }

  close(): void {
    this.#shown += 1;
    this.#plot.close();
  }

  async #historyOf({ id, sequence }: Render): Promise<readonly ConvergencePoint[]> {
    const key = `${id} ${sequence}`;
    const points = this.#known.get(key) ?? (await getConvergence(id).catch(() => []));
    this.#known.set(key, points);
    return points;
  }
}

function drawingOf(renders: readonly Render[], histories: readonly (readonly ConvergencePoint[])[], { colour, axis }: Style): Drawing {
  const { x, columns } = curvesOf(renders, histories);
  const firsts = columns.flatMap((column) => column.flatMap((error, index) => (error === null ? [] : [error * Math.sqrt(x[index] ?? 1)])));
  const constant = firsts.sort((a, b) => a - b)[Math.floor(firsts.length / 2)] ?? 1;
  return [
    [x, ...columns, x.map((value) => constant / Math.sqrt(value))],
    {
      height: 300,
      // Room for the label at the end.
      padding: [8, 40, 0, 0],
      scales: { x: logarithmicScale(1.5), y: logarithmicScale(1.5) },
      axes: [
        { ...axis, values: (_, values) => values.map((value) => (isDecade(value) ? seconds(value) : null)) },
        { ...axis, size: 64, values: (_, values) => values.map((value) => (value ? formatRelativeError(value) : null)) },
      ],
      series: [
        { label: "CPU time", value: (_, value: number | null) => (value === null ? "–" : seconds(value)) },
        ...renders.map(({ id, name }, index) => ({
          label: name || id,
          stroke: colour(lineColours[index % lineColours.length] ?? "--accent"),
          width: 2,
          spanGaps: true,
          points: { show: true, size: 5, fill: colour(lineColours[index % lineColours.length] ?? "--accent") },
          value: (_: uPlot, value: number | null) => (value === null ? "–" : formatRelativeError(value)),
        })),
        { label: "1/√time", stroke: colour("--muted"), dash: [6, 4], points: { show: false }, value: () => "" },
      ],
    },
  ];
}

/** Below a second the usual words would say 0.0 s. */
function seconds(value: number): string {
  return value < 1 ? `${value < 1e-3 ? value.toExponential(0) : Number(value.toPrecision(2))}\u00a0s` : formatDuration(value);
}

const isDecade = (value: number): boolean => Math.abs(Math.log10(value) - Math.round(Math.log10(value))) < 1e-9;

/** Efficiency: 1 / (error² × time), which does not change while a render goes on as 1/√N. */
function tableOf(renders: Render[], chosen: readonly Render[], choose: (ids: string[]) => void): HTMLElement {
  if (renders.length === 0) return element("p", { class: "muted" }, "No render has an error yet.");
  const shown = chosen.map(({ id }) => id);
  const rows = renders.map(({ id, name, progress }) => {
    const efficiency = 1 / (progress.relative_error ** 2 * progress.cpu_seconds);
    const cells = [seconds(progress.cpu_seconds), formatRelativeError(progress.relative_error), efficiency.toPrecision(3)];
    const box = element("input", { type: "checkbox", "aria-label": `Show ${name || id} (${id}) in the chart` });
    box.checked = shown.includes(id);
    box.addEventListener("change", () => { choose(box.checked ? [...shown, id] : shown.filter((each) => each !== id)); });
    return tableRow([box, " ", element("a", { href: renderRoute(id) }, name || id)], cells);
  });
  return table(["Render", "CPU time", "Relative error", "1 / (error² × s)"], rows);
}

function peers(): HTMLElement {
  const rows = summary.flatMap(({ scene, beside_peer }) => (beside_peer === null ? [] : [{ name: scene, value: beside_peer, others: [] }]));
  const caption = "Squared error of Nocturne as it comes, over that of Mitsuba's best variant in the same processor time; left of the line Nocturne has less. One run of small films on one machine: a factor of 1.5 may be chance. Scenes that Mitsuba can't show are left out.";
  return dotTable({ caption, columns: ["Scene", "Error over Mitsuba's", "Times"], rows, line: 1, format: (value) => `${Number(value.toPrecision(2))}` });
}

function ways(): HTMLElement {
  const rows = summary.map(({ scene, default: value, ways: others }) => ({ name: scene, value: value ?? undefined, others }));
  const caption = "Seconds of one processor to an image that is right to 1 %: by default (filled), and by each method that can be chosen (rings). The documentation has a chart for each scene.";
  return dotTable({ caption, columns: ["Scene", "CPU seconds to 1 %", "As it comes"], rows, format: seconds });
}
