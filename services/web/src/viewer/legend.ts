/** What the colours of a view mean: the map as a strip, with its numbers. */
import { element } from "../dom.ts";
import { formatValue } from "../format.ts";
import { mapBytes, maps, mapSize, ticks } from "../image/colour_maps.ts";
import { legendTitle, type Look } from "../image/look.ts";

export function legend(): { node: HTMLElement; show: (look: Look) => void } {
  const strip = element("canvas", { width: `${mapSize}`, height: "1", "aria-hidden": "true" });
  const numbers = element("div", { class: "ticks" });
  const title = element("p", {});
  const node = element("div", { class: "legend", role: "group", "aria-label": "Legend" }, title, strip, numbers);
  let shown = "";
  return {
    node,
    show: (look) => {
      node.hidden = look.show === "colour";
      const key = JSON.stringify([look.show, look.scale, look.measured.unit]);
      if (node.hidden || key === shown) return;
      shown = key;
      title.textContent = legendTitle(look.show, look.measured);
      const colours = look.show === "difference" ? maps.diverging : maps.viridis;
      strip.getContext("2d")?.putImageData(new ImageData(new Uint8ClampedArray(mapBytes(colours)), mapSize, 1), 0, 0);
      numbers.replaceChildren(
        ...ticks(look.scale).map(({ at, value }) => {
          const tick = element("span", {}, tickText(value));
          tick.style.left = `${100 * at}%`;
          return tick;
        }),
      );
    },
  };
}

function tickText(value: number): string {
  if (value === 0) return "0";
  const size = Math.abs(value);
  return size >= 1e5 || size < 1e-3 ? value.toExponential(0).replace("e+", "e") : `${Number(formatValue(value, 3))}`;
}
