/** A render's preview on a canvas, with its exposure slider. */
import { element, setText } from "../dom.ts";
import { formatStops } from "../format.ts";
import { applyExposure, exposureTable } from "../image/exposure.ts";
import { PreviewSource } from "../image/preview.ts";
import { hasEnded, hasImage, type Render } from "../service/types.ts";
import { samplesText } from "./progress_bar.ts";

export interface Picture {
  node: HTMLElement;
  show: (render: Render) => void;
  close: () => void;
}

export function picture(id: string): Picture {
  const canvas = element("canvas", { role: "img" });
  const waiting = element("p", { class: "waiting muted" }, "No samples yet.");
  const frame = element("div", { class: "frame" }, canvas, waiting);
  const paint = painter(canvas);
  const slider = exposureSlider((stops) => {
    paint.expose(stops);
  });
  const source = new PreviewSource(id, (pixels) => {
    paint.show(pixels);
    waiting.hidden = true;
    canvas.dataset.previews = `${Number(canvas.dataset.previews ?? 0) + 1}`;
  });

  const show = (render: Render): void => {
    frame.style.setProperty("--aspect", `${render.width} / ${render.height}`);
    frame.style.setProperty("--aspect-number", `${render.width / render.height}`);
    // Pixels of a small film are shown as squares, not as a blur.
    canvas.classList.toggle("small-film", render.width <= 256);
    canvas.setAttribute("aria-label", `Preview of ${render.name}, ${samplesText(render)}`);
    if (hasImage(render)) source.request();
    else if (hasEnded(render)) setText(waiting, "No image: it ended before its first samples.");
  };
  return {
    node: element("div", { class: "picture" }, frame, slider),
    show,
    close: () => {
      source.close();
    },
  };
}

function painter(canvas: HTMLCanvasElement): { show: (pixels: ImageData) => void; expose: (stops: number) => void } {
  const context = canvas.getContext("2d");
  let table = exposureTable(0);
  let source: ImageData | undefined;
  let shown: ImageData | undefined;

  const paint = (): void => {
    if (!source) return;
    if (shown?.width !== source.width || shown.height !== source.height) {
      shown = new ImageData(source.width, source.height);
      canvas.width = source.width;
      canvas.height = source.height;
    }
    applyExposure(source.data, shown.data, table);
    context?.putImageData(shown, 0, 0);
  };
  return {
    show: (pixels) => {
      source = pixels;
      paint();
    },
    expose: (stops) => {
      table = exposureTable(stops);
      paint();
    },
  };
}

function exposureSlider(onChange: (stops: number) => void): HTMLElement {
  const input = element("input", { type: "range", id: "exposure", min: "-6", max: "6", step: "0.1", value: "0", "aria-describedby": "exposure-note" });
  const value = element("output", { for: "exposure" });
  const reset = element("button", { type: "button", class: "quiet", "aria-label": "Reset exposure" }, "Reset");
  const changed = (): void => {
    const stops = input.valueAsNumber;
    setText(value, formatStops(stops));
    input.setAttribute("aria-valuetext", `${stops.toFixed(1)} stops`);
    reset.disabled = stops === 0;
    onChange(stops);
  };
  input.addEventListener("input", changed);
  reset.addEventListener("click", () => {
    input.value = "0";
    changed();
    input.focus();
  });
  changed();
  const note = "Preview exposure in stops (EV). The preview is a tone-mapped 8-bit picture: what it clipped stays clipped; the EXR has it all.";
  return element(
    "div",
    { class: "exposure" },
    element("label", { for: "exposure" }, "Exposure"),
    input,
    value,
    reset,
    element("p", { id: "exposure-note", class: "note" }, note),
  );
}
