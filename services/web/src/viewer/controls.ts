/** The tools over the image. */
import { announce, element, setText } from "../dom.ts";
import { formatStops, formatValue } from "../format.ts";
import { type Triple, whites } from "../image/colour.ts";
import { middleGrey, type Show, shows, type Tone, tones } from "../image/look.ts";
import { type Kind, kinds } from "../measure/outlines.ts";
import { nameOfWhite } from "./memory.ts";
import type { Viewer } from "./viewer.ts";

const showNames: Record<Show, string> = {
  colour: "Colour", luminance: "Value", error: "Standard error", "relative error": "Relative error",
  samples: "Samples", invalid_samples: "Invalid samples", difference: "Difference",
};
const toneNames: Record<Tone, string> = { linear: "Linear", reinhard: "Reinhard", filmic: "Filmic" };

export interface Controls {
  node: HTMLElement;
  /** Follows what changed by itself. */
  refresh: () => void;
  /** What is drawn on the image, rather than panned. */
  drawing: () => Kind | undefined;
}

interface Wishes {
  /** XYZ of what should look white: the chosen region, or the pixel looked at. */
  neutral: () => Triple | undefined;
  canCompare: boolean;
  /** What fills the screen when asked to. */
  picture: HTMLElement;
}

export function controls(viewer: Viewer, wishes: Wishes): Controls {
  const exposure = exposureSlider(viewer);
  const drawing = drawingButtons();
  const node = element(
    "div",
    { class: "tools", role: "group", "aria-label": "How the image is shown" },
    showChoice(viewer, wishes.canCompare),
    exposure.node,
    whiteChoice(viewer, wishes.neutral),
    select("Tone", tones.map((tone) => [tone, toneNames[tone]]), viewer.look.tone, (tone) => { viewer.change({ tone: tone as Tone }); }),
    element(
      "span",
      { class: "group" },
      tick("Clipping", (warnClipped) => { viewer.change({ warnClipped }); }),
      tick("Gamut", (warnGamut) => { viewer.change({ warnGamut }); }),
      tick("Workers", (workers) => { viewer.change({ workers }); }),
    ),
    element("span", { class: "group" }, ...drawing.nodes, ...zoomButtons(viewer), ...fullScreenButton(wishes.picture)),
  );
  return { node, refresh: exposure.refresh, drawing: drawing.kind };
}

const hints: Record<Kind, string> = {
  rectangle: "A drag chooses a region; so does Shift with a drag",
  polygon: "Clicks set corners; a double click ends",
  line: "A drag draws a line",
};

/** One of them is pressed, or none. */
function drawingButtons(): { nodes: HTMLElement[]; kind: () => Kind | undefined } {
  let pressed: Kind | undefined;
  const buttons = (Object.keys(kinds) as Kind[]).map((kind) => {
    const node = element("button", { type: "button", "aria-pressed": "false", title: hints[kind] }, kinds[kind]);
    node.addEventListener("click", () => {
      pressed = pressed === kind ? undefined : kind;
      for (const other of buttons) other.node.setAttribute("aria-pressed", `${other.kind === pressed}`);
    });
    return { kind, node };
  });
  return { nodes: buttons.map(({ node }) => node), kind: () => pressed };
}

function showChoice(viewer: Viewer, canCompare: boolean): HTMLElement {
  const offered = shows.filter((show) => canCompare || show !== "difference");
  return select("View", offered.map((show) => [show, showNames[show]]), viewer.look.show, (show) => { viewer.change({ show: show as Show }); });
}

function whiteChoice(viewer: Viewer, neutral: () => Triple | undefined): HTMLElement {
  const names: [string, string][] = [...Object.keys(whites).map((name): [string, string] => [name, name]), ["camera", "Camera"]];
  return select("White", names, nameOfWhite(viewer.look.white) ?? "camera", (name, input) => {
    const white = name === "camera" ? neutral() : whites[name as keyof typeof whites];
    if (white && white[1] > 0) {
      viewer.change({ white: white.map((value) => value / white[1]) as Triple });
      return;
    }
    input.value = nameOfWhite(viewer.look.white) ?? "camera";
    announce("Point at a pixel or choose a region first: that will look white");
  });
}

function exposureSlider(viewer: Viewer): { node: HTMLElement; refresh: () => void } {
  const input = element("input", { type: "range", id: "exposure", min: "-10", max: "10", step: "0.1", value: "0" });
  const value = element("output", { for: "exposure" });
  const auto = element("button", { type: "button", class: "quiet" }, "Auto");
  /** Exposure at the slider's middle: that of the image itself, when the slider was last left alone. */
  let middle = viewer.isAuto ? 1 : viewer.look.exposure;
  const refresh = (): void => {
    if (viewer.isAuto) {
      middle = viewer.look.exposure;
      input.value = "0";
    }
    const stops = input.valueAsNumber;
    const grey = `${formatValue(middleGrey / viewer.look.exposure, 3)} ${viewer.look.measured.unit}`.trim();
    setText(value, `${formatStops(stops)} · middle grey ${grey}`);
    input.setAttribute("aria-valuetext", `${stops.toFixed(1)} stops; middle grey is ${grey}`);
    auto.disabled = viewer.isAuto;
  };
  input.addEventListener("input", () => { viewer.change({ exposure: middle * 2 ** input.valueAsNumber }); });
  auto.addEventListener("click", () => { viewer.exposeByImage(); });
  return { node: element("span", { class: "exposure" }, element("label", { for: "exposure" }, "Exposure"), input, value, auto), refresh };
}

function zoomButtons(viewer: Viewer): HTMLElement[] {
  const button = (text: string, label: string, action: () => void): HTMLElement => {
    // Buttons with signs need a name; words are their own name, and must keep it.
    const node = element("button", { type: "button", title: label, "aria-label": /\w/.test(text) ? undefined : label }, text);
    node.addEventListener("click", action);
    return node;
  };
  return [
    button("−", "Zoom out", () => { viewer.zoom(0.5); }),
    button("+", "Zoom in", () => { viewer.zoom(2); }),
    button("1:1", "One pixel for one", () => { viewer.zoom(1 / viewer.placement.scale); }),
    button("Fit", "The whole image", () => { viewer.fit(); }),
  ];
}

/** The image with its tools, legend and numbers over the whole screen; Escape or the button ends it. None where the browser can't. */
function fullScreenButton(picture: HTMLElement): HTMLElement[] {
  if (!document.fullscreenEnabled) return [];
  const node = element("button", { type: "button", "aria-pressed": "false", title: "The image fills the screen; Escape ends it" }, "Full screen");
  node.addEventListener("click", () => {
    const change = document.fullscreenElement === picture ? document.exitFullscreen() : picture.requestFullscreen();
    change.catch(() => { announce("The browser does not give the whole screen"); });
  });
  picture.addEventListener("fullscreenchange", () => { node.setAttribute("aria-pressed", `${document.fullscreenElement === picture}`); });
  return [node];
}

type OnChange = (value: string, input: HTMLSelectElement) => void;

export function select(label: string, options: [string, string][], value: string, onChange: OnChange): HTMLElement {
  const input = element("select", {}, ...options.map(([name, text]) => element("option", { value: name }, text)));
  input.value = value;
  input.addEventListener("change", () => { onChange(input.value, input); });
  return element("label", { class: "select" }, element("span", {}, label), input);
}

function tick(label: string, onChange: (on: boolean) => void): HTMLElement {
  const input = element("input", { type: "checkbox" });
  input.addEventListener("change", () => { onChange(input.checked); });
  return element("label", { class: "tick" }, input, label);
}
