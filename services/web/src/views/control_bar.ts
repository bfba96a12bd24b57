/** What can be done to a render: pause, resume, more samples, another share of the workers, again. */
import { announce, element } from "../dom.ts";
import { wordsOf } from "../format.ts";
import { renderRoute } from "../router.ts";
import { pauseRender, replayRender, resumeRender, setTags } from "../service/controls.ts";
import { hasEnded, type Render } from "../service/types.ts";
import { askButton } from "./ask_button.ts";
import { extendFields, priorityFields, priorityMeaning, tagsFields } from "./control_fields.ts";

export interface ControlBar {
  node: HTMLElement;
  show: (render: Render) => void;
}

export function controlBar(id: string, onChange: (render: Render) => void): ControlBar {
  const changed = (text: string) => (render: Render): void => {
    onChange(render);
    announce(text);
  };
  const pause = element("button", { type: "button" }, "Pause");
  const resume = element("button", { type: "button" }, "Resume");
  const replay = element("button", { type: "button", title: "Trace it once more: the image has the same bits" }, "Replay");
  const problem = element("p", { class: "problem", role: "alert" });
  const pressed = (button: HTMLButtonElement, act: () => Promise<void>): void => {
    button.addEventListener("click", () => {
      problem.textContent = "";
      act().catch((error: unknown) => { problem.textContent = error instanceof Error ? error.message : String(error); });
    });
  };
  pressed(pause, () => pauseRender(id).then(changed("Paused")));
  pressed(resume, () => resumeRender(id).then(changed("It goes on")));
  pressed(replay, async () => {
    const again = await replayRender(id);
    onChange(again);
    location.hash = renderRoute(again.id);
  });
  const extend = extendButton(id, changed("It gets more"));
  const priority = priorityButton(id, changed("Its priority is changed"));
  const tags = tagsButton(id, changed("Its tags are changed"));
  const buttons = element("div", { class: "controls", role: "group", "aria-label": "What to do with it" }, pause, resume, extend.button, priority.button, tags.button, replay);
  return {
    node: element("div", {}, buttons, problem, extend.dialog, priority.dialog, tags.dialog),
    show: (render) => {
      pause.hidden = render.state !== "QUEUED" && render.state !== "RUNNING";
      resume.hidden = render.state !== "PAUSED" && render.state !== "DEGRADED";
      extend.show(render);
      priority.show(render);
      tags.show(render);
      priority.button.hidden = hasEnded(render);
      replay.hidden = render.progress.mean_samples === 0;
    },
  };
}

interface Asked {
  button: HTMLElement;
  dialog: HTMLElement;
  show: (render: Render) => void;
}

function extendButton(id: string, onChange: (render: Render) => void): Asked {
  const { node, samples, extend } = extendFields();
  const question = { act: "Extend", title: "More samples, or another error?", text: "Nothing is traced again; all other conditions stay.", keep: "Leave it", failed: "Not changed" };
  const asked = askButton(question, async () => { onChange(await extend(id)); }, node);
  return { ...asked, show: (render) => { if (!asked.dialog.open) samples.value = `${hasEnded(render) ? 2 * render.samples : render.samples}`; } };
}

function priorityButton(id: string, onChange: (render: Render) => void): Asked {
  const { node, weight, prioritise } = priorityFields();
  const question = { act: "Priority", title: "How much of the workers?", text: priorityMeaning, keep: "Leave it", failed: "Not changed" };
  const asked = askButton(question, async () => { onChange(await prioritise(id)); }, node);
  return { ...asked, show: ({ priority }) => { if (!asked.dialog.open) weight.value = `${priority}`; } };
}

function tagsButton(id: string, onChange: (render: Render) => void): Asked {
  const { node, words } = tagsFields();
  const question = { act: "Tags", title: "Tags", text: "Words to sort renders by, between commas.", keep: "Leave them", failed: "Not changed" };
  const asked = askButton(question, async () => { onChange(await setTags(id, wordsOf(words.value))); }, node);
  return { ...asked, show: ({ tags }) => { if (!asked.dialog.open) words.value = tags.join(", "); } };
}
