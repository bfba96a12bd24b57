/** All workers: now, over the last two days, and the worker events. */
import type uPlot from "uplot";
import { element, scroller, section, table, tableRow } from "../dom.ts";
import { formatCount } from "../format.ts";
import { type Drawing, Plot, type Style } from "../plot.ts";
import { getWorkerHistory } from "../service/client.ts";
import type { WorkerHistory } from "../service/types.ts";
import type { View } from "./view.ts";
import { usageSection } from "./usage_section.ts";
import { workersSection } from "./workers_section.ts";

const interval_ms = 10_000;
// The declarations name it in a const enum, which single-file compilers cannot read.
// eslint-disable-next-line @typescript-eslint/no-unsafe-enum-assignment
const right = 1 as uPlot.Axis.Side;

export function workersView(): View {
  const workers = workersSection();
  const usage = usageSection();
  const chart = element("div", { class: "plot" });
  const caption = element("p", { class: "note" });
  const events = scroller("events", "Table of events");
  const node = element(
    "div",
    {},
    element("h1", { tabindex: "-1" }, "Workers"),
    workers.node,
    usage.node,
    section("night", "The last two days", chart, caption),
    section("events", "Worker events", events),
  );
  const plot = new Plot(chart);
  const poll = async (): Promise<void> => {
    try {
      const [history] = await Promise.all([getWorkerHistory(), usage.load()]);
      plot.show(history.rates.length < 2 ? undefined : (style) => rates(history, style));
      caption.textContent = efficiencyText(history);
      events.replaceChildren(eventsTable(history));
    } catch {
      // The bar says that the service is out of reach.
    }
  };
  const timer = setInterval(() => void poll(), interval_ms);
  void poll();
  return {
    node,
    title: "Workers",
    close: () => {
      clearInterval(timer);
      workers.close();
      plot.close();
    },
  };
}

function rates({ rates: points }: WorkerHistory, { colour, axis }: Style): Drawing {
  const format = (_: uPlot, values: number[]): string[] => values.map((value) => formatCount(value));
  return [
    [points.map((point) => point.unix_time), points.map((point) => point.rays_per_second), points.map((point) => point.threads)],
    {
      height: 200,
      scales: { y: { range: (_plot, _low, high) => [0, 1.1 * (high || 1)] }, threads: { range: (_plot, _low, high) => [0, 1.5 * (high || 1)] } },
      axes: [axis, { ...axis, size: 64, values: format }, { ...axis, scale: "threads", side: right, grid: { show: false } }],
      series: [
        {},
        { label: "Rays/s", stroke: colour("--accent"), width: 2, value: (_, value: number | null) => (value === null ? "–" : formatCount(value)) },
        { label: "Threads", scale: "threads", stroke: colour("--cancelled"), width: 1, dash: [4, 3] },
      ],
    },
  ];
}

/** How much of what the threads can do was done: the mean rate per thread over the best there was. */
function efficiencyText({ rates: points }: WorkerHistory): string {
  const perThread = points.filter(({ threads }) => threads > 0).map(({ threads, rays_per_second }) => rays_per_second / threads);
  const best = Math.max(0, ...perThread);
  if (perThread.length < 2 || best === 0) return "A point for each minute; there are too few yet.";
  const mean = perThread.reduce((sum, value) => sum + value, 0) / perThread.length;
  return `${formatCount(mean)} rays/s per thread on the mean, ${((100 * mean) / best).toFixed(0)} % of the best minute. Idle time counts, and scenes differ.`;
}

function eventsTable({ events }: WorkerHistory): HTMLElement {
  if (events.length === 0) return element("p", { class: "muted" }, "Nothing happened yet.");
  const rows = events.map(({ unix_time, worker_id, what, reason }) => {
    const text = element("span", { title: reason }, reason ? `${what}: ${reason}` : what);
    return tableRow(new Date(1000 * unix_time).toLocaleString(), [worker_id, text]);
  });
  return table(["When", "Worker", "What"], rows);
}
