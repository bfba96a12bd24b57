/** "Render here first": the chosen region as a hint to the scheduler. */
import { announce, element, setText } from "../dom.ts";
import type { Region } from "../image/tiled_image.ts";
import { lookFirst } from "../service/client.ts";
import { hasEnded, type Render } from "../service/types.ts";

export interface LookFirstButton {
  node: HTMLElement;
  show: (render: Render | undefined) => void;
}

export function lookFirstButton(id: string, chosen: () => Region | undefined, onChange: (render: Render) => void): LookFirstButton {
  const here = element("button", { type: "button" }, "Render the region first");
  const everywhere = element("button", { type: "button" }, "All parts alike");
  const about = element("span", { class: "note", role: "status" });
  const node = element("div", { class: "look-first" }, here, everywhere, about);
  const ask = async (region: Region | undefined): Promise<void> => {
    try {
      onChange(await lookFirst(id, region));
      announce(region ? "The region gets its samples first" : "All parts are alike");
    } catch (error) {
      setText(about, error instanceof Error ? error.message : String(error));
    }
  };
  here.addEventListener("click", () => void ask(chosen()));
  everywhere.addEventListener("click", () => void ask(undefined));
  return {
    node,
    show: (render) => {
      node.hidden = !render || hasEnded(render);
      here.disabled = chosen() === undefined;
      const first = render?.look_first;
      everywhere.hidden = !first;
      setText(about, first ? `First: ${first.x}, ${first.y}, ${first.width} × ${first.height}` : "Choose a region to see it sooner.");
    },
  };
}
