/** A small picture of a render that is replaced only after the next one has loaded, so that it never flickers. */
import { element } from "../dom.ts";
import { thumbnailAddress } from "../service/client.ts";
import { hasEnded, hasImage, type Render } from "../service/types.ts";

/** A list of many renders must not fetch each picture every second. */
const interval_ms = 2000;

export function thumbnail(): { node: HTMLElement; show: (render: Render) => void } {
  const image = element("img", { alt: "" });
  const node = element("div", { class: "thumbnail" }, image);
  let shown = -1;
  let nextTime = 0;

  const show = (render: Render): void => {
    const due = hasEnded(render) || performance.now() >= nextTime;
    if (!hasImage(render) || render.sequence === shown || !due) return;
    shown = render.sequence;
    nextTime = performance.now() + interval_ms;
    const next = new Image();
    next.onload = () => {
      image.src = next.src;
      node.classList.add("loaded");
    };
    next.src = thumbnailAddress(render.id, render.sequence);
  };
  return { node, show };
}
