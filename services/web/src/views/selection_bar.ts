/** What can be done to several renders of the list at once. */
import { announce, element, setText } from "../dom.ts";
import { wordsOf } from "../format.ts";
import { cancelRender, deleteRender } from "../service/client.ts";
import { pauseRender, replayRender, resumeRender, setTags } from "../service/controls.ts";
import type { Renders } from "../service/renders.ts";
import { hasEnded, type Render } from "../service/types.ts";
import { askButton } from "./ask_button.ts";
import { extendFields, priorityFields, priorityMeaning, tagsFields } from "./control_fields.ts";

export interface SelectionBar {
  node: HTMLElement;
  /** Those that are selected now. */
  show: (selected: readonly Render[]) => void;
}

interface Act {
  name: string;
  /** To which of them it can be done. */
  fits: (render: Render) => boolean;
  act: (render: Render) => Promise<Render | undefined>;
  /** What is asked before; else it is done at once. */
  asks?: string;
  /** What is filled in before; without, what is asked can't be undone. */
  fields?: HTMLElement;
}

function actsOf(): Act[] {
  const [more, priority, tags] = [extendFields(), priorityFields(), tagsFields()];
  const withTags = (render: Render): Promise<Render> => setTags(render.id, [...new Set([...render.tags, ...wordsOf(tags.words.value)])]);
  return [
    { name: "Pause", fits: ({ state }) => state === "QUEUED" || state === "RUNNING", act: ({ id }) => pauseRender(id) },
    { name: "Resume", fits: ({ state }) => state === "PAUSED" || state === "DEGRADED", act: ({ id }) => resumeRender(id) },
    { name: "Extend", fits: () => true, act: ({ id }) => more.extend(id), asks: "Nothing is traced again; all other conditions stay.", fields: more.node },
    { name: "Priority", fits: (render) => !hasEnded(render), act: ({ id }) => priority.prioritise(id), asks: priorityMeaning, fields: priority.node },
    { name: "Add tags", fits: () => true, act: withTags, asks: "Beside those that they have; between commas.", fields: tags.node },
    { name: "Replay", fits: ({ progress }) => progress.mean_samples > 0, act: ({ id }) => replayRender(id) },
    { name: "Cancel", fits: (render) => !hasEnded(render), act: ({ id }) => cancelRender(id), asks: "They stop and cannot be continued. Their images so far are kept." },
    { name: "Delete", fits: hasEnded, act: ({ id }) => deleteRender(id).then(() => undefined), asks: "Their images, numbers and history are gone for good." },
  ];
}

/** `onAll`: all that the list shows are wanted; `onNone`: none any more. */
export function selectionBar(renders: Renders, onAll: () => void, onNone: () => void): SelectionBar {
  const count = element("span", { role: "status" });
  const none = element("button", { type: "button", class: "quiet" }, "Select none");
  none.addEventListener("click", onNone);
  const all = element("button", { type: "button", class: "quiet" }, "Select all");
  all.addEventListener("click", onAll);
  const problem = element("p", { class: "problem", role: "alert" });
  let selected: readonly Render[] = [];
  const run = async ({ name, fits, act }: Act): Promise<void> => {
    const those = selected.filter(fits);
    const failed: string[] = [];
    for (const render of those) {
      try {
        const changed = await act(render);
        if (changed) renders.put(changed);
        else renders.forget(render.id);
      } catch (error) {
        failed.push(`${render.name || render.id}: ${error instanceof Error ? error.message : String(error)}`);
      }
    }
    setText(problem, failed.join(" "));
    announce(`${name}: ${those.length - failed.length} of ${those.length}`);
    if (failed.length === 0) onNone();
  };
  const buttons = actsOf().map((act) => ({ act, ...buttonOf(act, () => run(act)) }));
  const node = element("div", { class: "tools selection", role: "group", "aria-label": "Selected renders" }, count, ...buttons.flatMap(({ nodes }) => nodes), all, none, problem);
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

function buttonOf({ name, asks, fields }: Act, act: () => Promise<void>): { button: HTMLElement; nodes: HTMLElement[] } {
  if (asks) {
    const { button, dialog } = askButton({ act: name, title: `${name} the selected renders?`, text: asks, keep: fields ? "Leave them" : "Keep them", failed: "Not done" }, act, fields);
    return { button, nodes: [button, dialog] };
  }
  const button = element("button", { type: "button" }, name);
  button.addEventListener("click", () => void act());
  return { button, nodes: [button] };
}
