/** A render's state: colour and word. */
import { element, setText } from "../dom.ts";
import { formatState } from "../format.ts";
import type { RenderState } from "../service/types.ts";

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
