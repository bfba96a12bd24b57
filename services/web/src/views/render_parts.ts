/** Small parts that show one render: its id, its state, how far it is. */
import { announce, element, setText } from "../dom.ts";
import { formatSamples, formatState } from "../format.ts";
import { fractionDone, type Render, type RenderState } from "../service/types.ts";

/** A render's id, as the command line wants it, and a button that copies it. */
export function idLine(id: string): HTMLElement {
  const text = element("code", {}, id);
  const copy = element("button", { type: "button", class: "quiet" }, "Copy id");
  copy.addEventListener("click", () => {
    // Without https there is no clipboard: then the id is selected, to be copied by hand.
    const copied = "clipboard" in navigator ? navigator.clipboard.writeText(id) : Promise.reject(new Error());
    copied.then(() => { announce("The id is copied"); }, () => { getSelection()?.selectAllChildren(text); });
  });
  return element("p", { class: "id" }, text, copy);
}

/** A render's state: colour and word. */
export function stateBadge(): { node: HTMLElement; show: (state: RenderState) => void } {
  const node = element("span", { class: "badge" });
  return {
    node,
    show: (state) => {
      node.dataset.state = state;
      setText(node, formatState(state));
    },
  };
}

/** How much of a render is merged. */
export function progressBar(): { node: HTMLElement; show: (render: Render) => void } {
  const node = element("progress", { max: "1", value: "0", "aria-label": "Samples completed" });
  return {
    node,
    show: (render) => {
      node.value = fractionDone(render);
      node.setAttribute("aria-valuetext", samplesText(render));
    },
  };
}

export function samplesText(render: Render): string {
  return `${formatSamples(render.progress.mean_samples)} of ${formatSamples(render.samples)} samples per pixel`;
}
