/** The range of false colour: two numbers that one sets and reads, and whether it is logarithmic. */
import { element } from "../dom.ts";
import { formatValue } from "../format.ts";
import type { Scale } from "../image/colour_maps.ts";
import type { Look } from "../image/look.ts";
import { select } from "./controls.ts";

/** `onRange`: a range was set; undefined: the image's own again. */
export function rangeForm(onRange: (scale: Scale | undefined) => void): { node: HTMLElement; show: (look: Look) => void } {
  const low = element("input", { type: "text", inputmode: "decimal", "aria-label": "Lowest value" });
  const high = element("input", { type: "text", inputmode: "decimal", "aria-label": "Highest value" });
  const auto = element("button", { type: "button", class: "quiet" }, "Auto range");
  let shown: Scale = { low: 0, high: 1, logarithmic: false };
  const take = (scale: Scale): void => {
    const isRange = scale.high > scale.low && Number.isFinite(scale.high) && Number.isFinite(scale.low);
    low.setAttribute("aria-invalid", `${!isRange}`);
    if (isRange) onRange(scale.logarithmic && scale.low <= 0 ? { ...scale, low: scale.high / 1000 } : scale);
  };
  const typed = (): void => { take({ ...shown, low: Number(low.value), high: Number(high.value) }); };
  const steps = select("Steps", [["log", "Logarithmic"], ["linear", "Linear"]], "log", (value) => { take({ ...shown, logarithmic: value === "log" }); });
  low.addEventListener("change", typed);
  high.addEventListener("change", typed);
  auto.addEventListener("click", () => { onRange(undefined); });
  const node = element("div", { class: "tools range" }, low, element("span", {}, "to"), high, steps, auto);
  return {
    node,
    show: ({ show, scale, ranges }) => {
      node.hidden = show !== "luminance" && show !== "error";
      shown = scale;
      auto.disabled = ranges[show] === undefined;
      const choice = steps.querySelector("select");
      if (choice) choice.value = scale.logarithmic ? "log" : "linear";
      for (const [input, value] of [[low, scale.low], [high, scale.high]] as const) {
        if (document.activeElement !== input) input.value = plain(value);
      }
    },
  };
}

function plain(value: number): string {
  return value === 0 ? "0" : `${Number(formatValue(value, 4))}`;
}
