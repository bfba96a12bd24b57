/** A denoised picture beside the true image: asked for by a button, labelled, and never what is measured. */
import { element, setText } from "../dom.ts";
import { derivedAddress, makePicture, previewAddress } from "../service/client.ts";
import { hasImage, type Render } from "../service/types.ts";

const pictures = [
  { name: "preview.png", title: "True image", text: "The measured image, with its noise." },
  { name: "denoised.png", title: "Denoised, to look at", text: "Made by Open Image Denoise. No error, stop condition, comparison or reading uses it." },
  { name: "difference.png", title: "Where they differ", text: "Dark: within the true image's error bar. Blue: beyond it, yellow: beyond two, red: beyond three. There something was lost or invented." },
] as const;

export function denoisedSection(id: string): { node: HTMLElement; show: (render: Render) => void } {
  const button = element("button", { type: "button" }, "Show a denoised picture");
  const problem = element("p", { class: "problem", role: "alert" });
  const figures = element("div", { class: "denoised" });
  const file = element("a", { href: derivedAddress(id, "denoised.exr"), download: "", hidden: "" }, "Denoised EXR");
  const head = element("div", { class: "section-head" }, element("h2", { id: "denoised-title" }, "Denoised"), element("span", {}, file, " ", button));
  const node = element("section", { class: "wide", "aria-labelledby": "denoised-title", hidden: "" }, head, problem, figures);
  let sequence = 0;
  const load = async (): Promise<void> => {
    button.disabled = true;
    setText(problem, "");
    setText(button, "Denoising…");
    try {
      // The first answer takes the time, and has the error message.
      await makePicture(id, "denoised.png");
      figures.replaceChildren(...pictures.map((picture) => figure(id, picture, sequence)));
      file.hidden = false;
    } catch (error) {
      setText(problem, error instanceof Error ? error.message : String(error));
    }
    setText(button, figures.childElementCount > 0 ? "Denoise again" : "Show a denoised picture");
    button.disabled = false;
  };
  button.addEventListener("click", () => { void load(); });
  return {
    node,
    show: (render) => {
      sequence = render.sequence;
      node.hidden = !hasImage(render);
    },
  };
}

function figure(id: string, { name, title, text }: (typeof pictures)[number], sequence: number): HTMLElement {
  const address = name === "preview.png" ? previewAddress(id, sequence) : `${derivedAddress(id, name)}?v=${sequence}`;
  return element("figure", {}, element("img", { src: address, alt: title }), element("figcaption", { class: "note" }, element("strong", {}, `${title}.`), ` ${text}`));
}
