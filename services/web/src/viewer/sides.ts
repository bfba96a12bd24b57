/** Which of two images is seen: one, the other, or both beside a wipe; flipping between them. */
import { element } from "../dom.ts";
import type { Look } from "../image/look.ts";
import type { Viewer } from "./viewer.ts";

const names: Record<Look["side"], string> = { first: "First", second: "Second", wipe: "Wipe" };

export function sides(viewer: Viewer | undefined): { node: HTMLElement; show: () => void } {
  const inputs = Object.keys(names).map((side) => element("input", { type: "radio", name: "side", value: side }));
  const slider = element("input", { type: "range", min: "0", max: "1", step: "0.005", value: "0.5", "aria-label": "Place of the wipe" });
  const flip = element("button", { type: "button", title: "Key F on the image" }, "Flip");
  const choose = (side: Look["side"]): void => {
    viewer?.change({ side });
    for (const input of inputs) input.checked = input.value === side;
    slider.disabled = side !== "wipe";
  };
  for (const input of inputs) input.addEventListener("change", () => { choose(input.value as Look["side"]); });
  slider.addEventListener("input", () => { viewer?.change({ wipe: slider.valueAsNumber }); });
  const flipped = (): void => { choose(viewer?.look.side === "first" ? "second" : "first"); };
  flip.addEventListener("click", flipped);
  viewer?.canvas.addEventListener("keydown", (event) => {
    if (event.key.toLowerCase() === "f" && !event.ctrlKey && !event.metaKey) flipped();
  });
  const labels = inputs.map((input) => element("label", {}, input, names[input.value as Look["side"]]));
  const legend = element("legend", { class: "visually-hidden" }, "Which image is seen");
  const node = element("div", { class: "tools sides" }, element("fieldset", { class: "choice" }, legend, ...labels), slider, flip);
  node.hidden = true;
  return {
    node,
    show: () => {
      if (!node.hidden) return;
      node.hidden = false;
      slider.valueAsNumber = viewer?.look.wipe ?? 0.5;
      // As in the address; the default is the wipe.
      choose(viewer?.look.side === "second" ? "second" : "wipe");
    },
  };
}
