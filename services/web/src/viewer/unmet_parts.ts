/** The parts of an image in which light may be missing that its errors don't show: a switch for them, and what they mean. */
import { element, setText } from "../dom.ts";
import type { Render, UnmetPart } from "../service/types.ts";

export interface UnmetParts {
  node: HTMLElement;
  show: (render: Render) => void;
}

/** `onChange` gets those to be drawn: none where they are switched off. */
export function unmetParts(onChange: (drawn: readonly UnmetPart[]) => void): UnmetParts {
  const input = element("input", { type: "checkbox", checked: "", "aria-describedby": "unmet-parts" });
  const text = element("span", { id: "unmet-parts" });
  const node = element("p", { class: "unmet note" }, element("label", { class: "tick" }, input, "Doubtful parts"), " ", text);
  let parts: readonly UnmetPart[] = [];
  const tell = (): void => { onChange(input.checked ? parts : []); };
  input.addEventListener("change", tell);
  node.hidden = true;
  return {
    node,
    show: (render) => {
      const now = render.warnings.flatMap((warning) => warning.parts);
      const changed = JSON.stringify(now) !== JSON.stringify(parts);
      parts = now;
      node.hidden = parts.length === 0;
      setText(text, sentence(parts, render));
      if (changed) tell();
    },
  };
}

/** How much of the image they are, and what that says. */
export function sentence(parts: readonly UnmetPart[], { width, height }: Pick<Render, "width" | "height">): string {
  const part = parts.reduce((sum, each) => sum + each.width * each.height, 0) / (width * height);
  const percent = part < 0.01 ? "less than 1 %" : `${Math.round(100 * part)} %`;
  return `Hatched, ${percent} of the image: light of small bright sources may be missing there, and standard errors do not show it.`;
}
