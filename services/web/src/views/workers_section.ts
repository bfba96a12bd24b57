/** Who works: a table, asked for every two seconds. */
import { element } from "../dom.ts";
import { formatCount } from "../format.ts";
import { listWorkers } from "../service/client.ts";
import type { Worker } from "../service/types.ts";

const interval_ms = 2000;

export function workersSection(): { node: HTMLElement; close: () => void } {
  const content = element("div", { class: "workers" });
  const node = element("section", { "aria-labelledby": "workers-title" }, element("h2", { id: "workers-title" }, "Workers"), content);

  const poll = async (): Promise<void> => {
    if (document.hidden) return;
    try {
      const workers = await listWorkers();
      content.replaceChildren(workers.length > 0 ? table(workers) : noWorkers());
    } catch {
      // The bar says that the service is out of reach.
    }
  };
  const timer = setInterval(() => void poll(), interval_ms);
  void poll();

  return {
    node,
    close: () => {
      clearInterval(timer);
    },
  };
}

function table(workers: Worker[]): HTMLElement {
  const headings = ["Worker", "Threads", "Photons/s", "Jobs done"];
  const rows = workers.toSorted((a, b) => a.id.localeCompare(b.id)).map(row);
  return element(
    "table",
    {},
    element("thead", {}, element("tr", {}, ...headings.map((text) => element("th", { scope: "col" }, text)))),
    element("tbody", {}, ...rows),
  );
}

function row(worker: Worker): HTMLElement {
  const cells = [`${worker.threads}`, formatCount(worker.photons_per_second), formatCount(worker.jobs_done)];
  return element("tr", {}, element("th", { scope: "row" }, worker.id), ...cells.map((text) => element("td", {}, text)));
}

function noWorkers(): HTMLElement {
  return element(
    "p",
    { class: "muted" },
    "No workers: renders wait until one joins. Start one with ",
    element("code", {}, "nocturne up"),
    " or ",
    element("code", {}, "nocturne-worker"),
    ".",
  );
}
