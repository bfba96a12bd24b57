/** What can be done to several renders of the list at once. */
import { announce, element, setText } from "../dom.ts";
import { cancelRender, deleteRender } from "../service/client.ts";
import { pauseRender, replayRender, resumeRender } from "../service/controls.ts";
import type { Renders } from "../service/renders.ts";
import { hasEnded, type Render } from "../service/types.ts";
import { askButton } from "./ask_button.ts";

export interface SelectionBar {
  node: HTMLElement;
  /** Those that are selected now. */
  show: (selected: readonly Render[]) => void;
}

interface Act {
  name: string;
  /** To which of them it can be done. */
  fits: (render: Render) => boolean;
  act: (id: string) => Promise<Render | undefined>;
  /** What is asked before; else it is done at once. */
  asks?: string;
}

const acts: Act[] = [
  { name: "Pause", fits: ({ state }) => state === "QUEUED" || state === "RUNNING", act: pauseRender },
  { name: "Resume", fits: ({ state }) => state === "PAUSED" || state === "DEGRADED", act: resumeRender },
  { name: "Replay", fits: ({ progress }) => progress.mean_samples > 0, act: replayRender },
  { name: "Cancel", fits: (render) => !hasEnded(render), act: cancelRender, asks: "They stop and cannot be continued. Their images so far are kept." },
  { name: "Delete", fits: hasEnded, act: (id) => deleteRender(id).then(() => undefined), asks: "Their images, numbers and history are gone for good." },
];

export function selectionBar(renders: Renders, onDone: () => void): SelectionBar {
  const count = element("span", { role: "status" });
  const none = element("button", { type: "button", class: "quiet" }, "Select none");
  none.addEventListener("click", onDone);
  const problem = element("p", { class: "problem", role: "alert" });
  let selected: readonly Render[] = [];
  const run = async ({ name, fits, act }: Act): Promise<void> => {
    const those = selected.filter(fits);
    const failed: string[] = [];
    for (const { id, name: called } of those) {
      try {
        const changed = await act(id);
        if (changed) renders.put(changed);
        else renders.forget(id);
      } catch (error) {
        failed.push(`${called || id}: ${error instanceof Error ? error.message : String(error)}`);
      }
    }
    setText(problem, failed.join(" "));
    announce(`${name}: ${those.length - failed.length} of ${those.length}`);
    if (failed.length === 0) onDone();
  };
  const buttons = acts.map((act) => ({ act, ...buttonOf(act, () => run(act)) }));
  const node = element("div", { class: "tools selection", role: "group", "aria-label": "Selected renders" }, count, ...buttons.flatMap(({ nodes }) => nodes), none, problem);
  node.hidden = true;
  return {
    node,
    show: (now) => {
      selected = now;
      node.hidden = now.length === 0;
      setText(count, `${now.length} selected`);
      for (const { act, button } of buttons) button.hidden = !now.some(act.fits);
    },
  };
}

function buttonOf({ name, asks }: Act, act: () => Promise<void>): { button: HTMLElement; nodes: HTMLElement[] } {
  if (asks) {
    const { button, dialog } = askButton({ act: name, title: `${name} the selected renders?`, text: asks, keep: "Keep them", failed: "Not done" }, act);
    return { button, nodes: [button, dialog] };
  }
  const button = element("button", { type: "button" }, name);
  button.addEventListener("click", () => void act());
  return { button, nodes: [button] };
}
