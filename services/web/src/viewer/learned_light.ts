/** Where the light of a place comes from by mirrors and glass, as a pilot learned it: a map of directions. */
import { element, setText } from "../dom.ts";
import { getLearnedLight } from "../service/client.ts";
import type { LearnedLight, Render } from "../service/types.ts";
import { outlineOf } from "./directions.ts";

/** Milliseconds that a place must be looked at before the service reads the scene for it. */
const rest = 400;

export interface LearnedLightView {
  node: HTMLElement;
  /** There is something to see only where photons are guided. */
  show: (render: Render) => void;
  showPixel: (pixel: { x: number; y: number }) => void;
  close: () => void;
}

export function learnedLightView(id: string): LearnedLightView {
  const disc = svg("svg", { viewBox: "-1.04 -1.04 2.08 2.08", role: "img", "aria-label": "Directions that light was learned to come from" });
  const text = element("p", { class: "note" }, "Point at the image.");
  const node = element("details", { class: "learned-light" }, element("summary", {}, "Learned light"), text, disc);
  node.hidden = true;
  disc.setAttribute("hidden", "");
  let at: { x: number; y: number } | undefined;
  let timer = 0;
  const request = async ({ x, y }: { x: number; y: number }): Promise<void> => {
    setText(text, `Looking at ${x}, ${y}…`);
    try {
      const found = await getLearnedLight(id, x, y);
      if (at?.x !== x || at.y !== y) return;
      setText(text, sentence(found, x, y));
      draw(disc, found);
    } catch (error) {
      if (at?.x === x && at.y === y) setText(text, error instanceof Error ? error.message : String(error));
    }
  };
  const ask = (): void => {
    window.clearTimeout(timer);
    if (!node.open || node.hidden) return;
    timer = window.setTimeout(() => {
      if (at) void request(at);
    }, rest);
  };
  node.addEventListener("toggle", ask);
  return {
    node,
    show: ({ guided }) => {
      node.hidden = !guided;
    },
    showPixel: (pixel) => {
      if (at?.x === pixel.x && at.y === pixel.y) return;
      at = pixel;
      ask();
    },
    close: () => {
      window.clearTimeout(timer);
    },
  };
}

function sentence({ normal, interfaces, cones }: LearnedLight, x: number, y: number): string {
  if (!normal) return `${x}, ${y}: no surface is seen.`;
  const seen = interfaces === 0 ? "seen directly" : `seen by ${interfaces} ${interfaces === 1 ? "mirror or boundary" : "mirrors and boundaries"}`;
  if (cones.length === 0) return `${x}, ${y}, ${seen}: nothing was learned nearby.`;
  return `${x}, ${y}, ${seen}: ${cones.length} cones of directions that light comes from by mirrors or glass. In the middle is the surface's normal, dashed 30 and 60 degrees from it, at the rim what grazes the surface, at the top what lies behind it.`;
}

function draw(disc: SVGElement, { normal, direction, cones }: LearnedLight): void {
  disc.toggleAttribute("hidden", !normal || cones.length === 0);
  if (!normal || !direction) return;
  const shapes = cones.map((cone) => svg("polygon", { points: outlineOf(cone, normal, direction).map((point) => point.map((each) => each.toFixed(4)).join(",")).join(" ") }));
  disc.replaceChildren(svg("circle", { r: "1" }), svg("circle", { r: "0.7071", class: "scale" }), svg("circle", { r: "0.3660", class: "scale" }), ...shapes);
}

function svg(tag: string, attributes: Record<string, string>): SVGElement {
  const node = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  return node;
}
