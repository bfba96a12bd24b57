/** Browser notifications of renders that end; off until somebody asks for them. */
import { element } from "../dom.ts";
import { formatState } from "../format.ts";
import type { Renders } from "./renders.ts";
import { hasEnded, type Render, type RenderState } from "./types.ts";

const key = "nocturne-notify";

const wanted = (): boolean => localStorage.getItem(key) === "yes" && "Notification" in window && Notification.permission === "granted";

/** Tells of each render that ends while the page is open, in whatever tab. */
export function notifyOfEnds(renders: Renders): void {
  const states = new Map<string, RenderState>();
  renders.subscribe(() => {
    for (const render of renders.newestFirst()) {
      if (ended(states.get(render.id), render) && wanted()) tell(render);
      states.set(render.id, render.state);
    }
  });
}

/** Whether it ended since; what was never seen to be open did not. */
export function ended(before: RenderState | undefined, now: Pick<Render, "state">): boolean {
  return before !== undefined && !hasEnded({ state: before } as Render) && hasEnded(now as Render);
}

function tell({ id, name, state, reason }: Render): void {
  new Notification(`${name || id}: ${formatState(state)}`, { body: reason, tag: id });
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
