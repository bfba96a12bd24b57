/** Browser notifications of renders that end or will miss their error; off until somebody asks for them. */
import { element } from "../dom.ts";
import { formatState } from "../format.ts";
import type { Renders } from "./renders.ts";
import { hasEnded, type Render, type RenderState } from "./types.ts";

const key = "nocturne-notify";

const wanted = (): boolean => localStorage.getItem(key) === "yes" && "Notification" in window && Notification.permission === "granted";

/** Tells of each render that ends, or turns out to miss its error, while the page is open, in whatever tab. */
export function notifyOfEnds(renders: Renders): void {
  const states = new Map<string, RenderState>();
  const missing = new Set<string>();
  renders.subscribe(() => {
    for (const render of renders.newestFirst()) {
      if (ended(states.get(render.id), render) && wanted()) tell(render, formatState(render.state), render.reason);
      if (isNewMiss(missing, states.get(render.id), render) && wanted()) tell(render, "its error is out of reach", render.target_unreachable);
      states.set(render.id, render.state);
    }
  });
}

/** Whether it will miss its error, which was not told before: once for each render, and not of what was so when the page opened. */
export function isNewMiss(told: Set<string>, before: RenderState | undefined, { id, target_unreachable }: Pick<Render, "id" | "target_unreachable">): boolean {
  if (target_unreachable === "" || told.has(id)) return false;
  told.add(id);
  return before !== undefined;
}

/** Whether it ended since; what was never seen to be open did not. */
export function ended(before: RenderState | undefined, now: Pick<Render, "state">): boolean {
  return before !== undefined && !hasEnded({ state: before } as Render) && hasEnded(now as Render);
}

function tell({ id, name }: Render, what: string, body: string): void {
  new Notification(`${name || id}: ${what}`, { body, tag: id });
}

/** Where it is asked for; browsers want to be asked by a click. */
export function notifyBox(): HTMLElement {
  const box = element("input", { type: "checkbox" });
  box.checked = wanted();
  box.addEventListener("change", () => void choose(box));
  const label = element("label", { class: "notify" }, box, "Notify me of ends");
  label.hidden = !("Notification" in window);
  return label;
}

async function choose(box: HTMLInputElement): Promise<void> {
  localStorage.setItem(key, box.checked ? "yes" : "no");
  if (box.checked) await Notification.requestPermission();
  box.checked = wanted();
}
