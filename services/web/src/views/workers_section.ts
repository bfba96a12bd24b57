/** Table of the workers, updated every two seconds, and the tiles of a render that each is tracing. */
import { announce, element, scroller, section, table } from "../dom.ts";
import { formatCount, formatDuration } from "../format.ts";
import { renderRoute } from "../router.ts";
import { getTilesInProgress, changeWorker, listWork, listWorkers } from "../service/client.ts";
import { serviceNow } from "../service/clock.ts";
import type { Worker, WorkOfWorker } from "../service/types.ts";

const interval_ms = 2000;

interface Watched {
  /** A render. */
  id: string;
  /** Numbers of workers, from 1, by tile. */
  onTilesInProgress: (byTile: ReadonlyMap<number, number>) => void;
}

export function workersSection(watched?: Watched): { node: HTMLElement; close: () => void } {
  const content = scroller("workers", "Table of workers");
  const node = section("workers", "Workers", content);
  const numbers = new Map<string, number>();
  const numberOf = (worker: string): number => {
    const known = numbers.get(worker) ?? numbers.size + 1;
    numbers.set(worker, known);
    return known;
  };

  const poll = async (): Promise<void> => {
    if (document.hidden) return;
    try {
      const [workers, work, inProgress] = await Promise.all([listWorkers(), listWork(), watched ? getTilesInProgress(watched.id) : []]);
      for (const { id } of workers.toSorted((a, b) => a.id.localeCompare(b.id))) numberOf(id);
      watched?.onTilesInProgress(new Map(inProgress.map(({ tile, worker }) => [tile, numberOf(worker)])));
      const tiles = (worker: string): string => `${inProgress.filter((each) => each.worker === worker).length}`;
      replace(content, workers.length > 0 ? workersTable(workers, work, watched && tiles) : noWorkers());
    } catch {
      // The bar says that the service is out of reach, or the render that there is none.
    }
  };
  const timer = setInterval(() => void poll(), interval_ms);
  void poll();
  return { node, close: () => { clearInterval(timer); } };
}

/** What is labelled and has the focus keeps it, where it is still there. */
function replace(content: HTMLElement, child: HTMLElement): void {
  const focused = content.querySelector(":focus")?.getAttribute("aria-label");
  content.replaceChildren(child);
  if (focused) content.querySelector<HTMLElement>(`[aria-label="${CSS.escape(focused)}"]`)?.focus();
}

function workersTable(workers: Worker[], work: WorkOfWorker[], tiles: ((worker: string) => string) | undefined): HTMLElement {
  // Beside an image there is little room.
  const headings = ["Worker", "Traces", ...(tiles ? ["Rays/s", "Jobs", "Tiles"] : ["Threads", "Rays/s", "Jobs done"])];
  const rows = workers.toSorted((a, b) => a.id.localeCompare(b.id)).map((worker) => row(worker, work.filter((each) => each.worker === worker.id), tiles ? [tiles(worker.id)] : []));
  return table(headings, rows);
}

function row(worker: Worker, work: WorkOfWorker[], more: string[]): HTMLElement {
  const cells = [...(more.length > 0 ? [] : [`${worker.threads}`]), formatCount(worker.rays_per_second), formatCount(worker.jobs_done), ...more];
  const name = element("th", { scope: "row" }, worker.id);
  if (worker.quarantine) name.append(badge("FAILED", "Quarantine", worker.quarantine), actButton(worker.id, "release"));
  else if (worker.drain) name.append(badge("PAUSED", worker.drain === "drained" ? "Drained" : "Draining", "It gets no jobs until it is released."), actButton(worker.id, "release"));
  else if (worker.incompatible) name.append(badge("PAUSED", "No jobs", worker.incompatible));
  // Beside an image there is little room, and no need.
  if (!worker.quarantine && !worker.drain && more.length === 0) name.append(actButton(worker.id, "drain"));
  return element("tr", {}, name, element("td", { class: "traces" }, ...work.map(traced)), ...cells.map((text) => element("td", {}, text)));
}

function badge(state: string, text: string, title: string): HTMLElement {
  return element("span", { class: "badge", "data-state": state, title }, text);
}

/** The table follows within two seconds. */
function actButton(worker: string, act: "drain" | "release"): HTMLElement {
  const word = act === "drain" ? "Drain" : "Release";
  const title = act === "drain" ? "It finishes the jobs that it has and gets no others" : "It gets jobs again, and its results are taken";
  const button = element("button", { type: "button", class: "release", title, "aria-label": `${word} ${worker}` }, word);
  button.addEventListener("click", () => {
    changeWorker(worker, act).then(
      () => { announce(act === "drain" ? `${worker} is being drained` : `${worker} is released`); },
      (error: unknown) => { announce(error instanceof Error ? error.message : String(error)); },
    );
  });
  return button;
}

/** "headlight, for 8 min": which render, and since when it has the oldest of its tiles. */
function traced({ render, name, since }: WorkOfWorker): HTMLElement {
  const seconds = Math.max(0, serviceNow() - since);
  return element("span", {}, element("a", { href: renderRoute(render) }, name || render), seconds >= 60 ? `, for ${formatDuration(seconds)}` : "");
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
