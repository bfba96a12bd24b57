/** A small picture of a render that is replaced only after the next one has loaded, so that it never flickers. */
import { element } from "../dom.ts";
import { thumbnailAddress } from "../service/client.ts";
import { hasEnded, hasImage, type Render } from "../service/types.ts";

/** A list of many renders must not fetch each picture every second. */
const interval_ms = 2000;

/** What is done once for a row that comes near the window: of hundreds most pictures are never seen. */
const whenNear = new WeakMap<Element, () => void>();
const near = new IntersectionObserver((entries) => {
  for (const { target, isIntersecting } of entries) {
    if (!isIntersecting) continue;
    near.unobserve(target);
    whenNear.get(target)?.();
  }
}, { rootMargin: "400px" });

/** It is fetched when `row`, which holds it, is in sight or nearly. */
export function thumbnail(row: Element): { node: HTMLElement; show: (render: Render) => void } {
  const image = element("img", { alt: "" });
  const node = element("div", { class: "thumbnail" }, image);
  let shown = -1;
  let nextTime = 0;
  let isNear = false;
  let last: Render | undefined;

  const show = (render: Render): void => {
    last = render;
    if (!isNear) return;
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
  whenNear.set(row, () => {
    isNear = true;
    if (last) show(last);
  });
  near.observe(row);
  return { node, show };
}
