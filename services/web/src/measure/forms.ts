/** What people say of a part to measure, and of isolines. */
import { element, setText } from "../dom.ts";
import type { Outline } from "../service/types.ts";
import { select } from "../viewer/controls.ts";
import { type Kind, kinds, parsePoints, pointsText } from "./outlines.ts";

/** Drawn on the image or typed: kind, points and a name. */
export function outlineForm(onAdd: (outline: Outline) => Promise<void>): { node: HTMLElement; fill: (outline: Outline) => void } {
  let kind: Kind = "rectangle";
  const choice = select("Part", Object.entries(kinds), kind, (chosen) => { kind = chosen as Kind; });
  const points = element("input", { type: "text", placeholder: "8,8 24,24", "aria-label": "Points in pixels" });
  const name = element("input", { type: "text", placeholder: "Name", "aria-label": "Name of the part", maxlength: "100" });
  const problem = element("p", { class: "problem", role: "alert" });
  const node = element("form", { class: "tools" }, choice, points, name, element("button", { type: "submit" }, "Add"), problem);
  node.addEventListener("submit", (event) => {
    event.preventDefault();
    try {
      const outline = { kind, points: parsePoints(kind, points.value), name: name.value.trim() };
      setText(problem, "");
      name.value = "";
      points.value = "";
      void onAdd(outline);
    } catch (error) {
      setText(problem, error instanceof Error ? error.message : String(error));
    }
  });
  return {
    node,
    fill: (outline) => {
      kind = outline.kind;
      const input = choice.querySelector("select");
      if (input) input.value = kind;
      points.value = pointsText(outline.points);
    },
  };
}

/** `levels`: undefined where none are wanted; empty: the service's own. */
export function isolineControls(onChange: () => void): { node: HTMLElement; levels: () => number[] | undefined } {
  const tick = element("input", { type: "checkbox" });
  const input = element("input", { type: "text", placeholder: "100, 200, 500", "aria-label": "Values of isolines" });
  tick.addEventListener("change", onChange);
  input.addEventListener("change", onChange);
  return {
    node: element("div", { class: "tools" }, element("label", { class: "tick" }, tick, "Isolines"), input),
    levels: () => (tick.checked ? input.value.split(/[\s,;]+/).filter(Boolean).map(Number).filter(Number.isFinite) : undefined),
  };
}
