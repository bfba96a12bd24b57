/** What is filled in before a render is changed, or several are. */
import { element } from "../dom.ts";
import { extendRender, setPriority } from "../service/controls.ts";
import type { Render } from "../service/types.ts";

export const priorityMeaning = "1 to 1000, beside others of its owner; 100 is usual, 200 gets twice the work.";

/** Samples and an error; empty is as before. */
export function extendFields(): { node: HTMLElement; samples: HTMLInputElement; extend: (id: string) => Promise<Render> } {
  const samples = element("input", { type: "number", min: "1", step: "1" });
  const error = element("input", { type: "number", min: "0", max: "100", step: "any" });
  return {
    node: fields(["Samples per pixel, in all (empty: as before)", samples], ["Stop at a relative error of, % (empty: as before)", error]),
    samples,
    extend: (id) => extendRender(id, samples.valueAsNumber || 0, error.valueAsNumber > 0 ? error.valueAsNumber / 100 : undefined),
  };
}

export function priorityFields(): { node: HTMLElement; weight: HTMLInputElement; prioritise: (id: string) => Promise<Render> } {
  const weight = element("input", { type: "number", min: "1", max: "1000", step: "1", value: "100" });
  return { node: fields(["Priority", weight]), weight, prioritise: (id) => setPriority(id, weight.valueAsNumber || 0) };
}

/** Words between commas. */
export function tagsFields(): { node: HTMLElement; words: HTMLInputElement } {
  const words = element("input", { type: "text", maxlength: "2000" });
  return { node: fields(["Tags", words]), words };
}

function fields(...labelled: [label: string, input: HTMLElement][]): HTMLElement {
  return element("div", { class: "fields" }, ...labelled.map(([label, input]) => element("label", {}, element("span", {}, label), input)));
}
