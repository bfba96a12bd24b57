/** How much of a render is merged. */
import { element } from "../dom.ts";
import { formatSamples } from "../format.ts";
import { fractionDone, type Render } from "../service/types.ts";

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
