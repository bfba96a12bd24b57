/** A render's image with its tools: fetched tile by tile, followed as it grows. */
import { announce, element, setText } from "../dom.ts";
import type { Triple } from "../image/colour.ts";
import { clipped, type TiledImage, type Region } from "../image/tiled_image.ts";
import { type Measured, measured } from "../image/look.ts";
import { ImageSource } from "../image/image_source.ts";
import { readRegion, tilesAddress } from "../service/client.ts";
import { hasEnded, type Outline, type RegionReading, type Render } from "../service/types.ts";
import { samplesText } from "../views/render_parts.ts";
import { recall, rememberer } from "./address.ts";
import { controls } from "./controls.ts";
import { type GestureListener, listenToGestures } from "./gestures.ts";
import { type Inspector, inspector } from "./inspector.ts";
import { learnedLightView, type LearnedLightView } from "./learned_light.ts";
import { legend } from "./legend.ts";
import { Overlay } from "./overlay.ts";
import { rangeForm } from "./range_form.ts";
import { unmetParts } from "./unmet_parts.ts";
import { Viewer } from "./viewer.ts";

const keys = "Arrow keys move from pixel to pixel, with Shift they pan. Plus and minus zoom, 1 shows pixel for pixel, 0 the whole image. With Region, Line or Polygon pressed, Enter sets a corner at the selected pixel; Escape discards the drawing.";

export interface RenderImage {
  node: HTMLElement;
  /** Undefined where this browser can't show images. */
  viewer: Viewer | undefined;
  overlay: Overlay;
  show: (render: Render) => void;
  /** Fetches what changed, if anything did. */
  refresh: () => void;
  chosen: () => Region | undefined;
  close: () => void;
}

/** What stands in the image's place as long as no tile is there. */
export function whyNothingIsShown(render: Render): string {
  if (render.progress.mean_samples > 0) return "Loading the image.";
  return hasEnded(render) ? "No image: it ended before its first samples." : "No samples yet.";
}

export interface Hooks {
  /** The first tiles are there. */
  onImage?: (image: TiledImage) => void;
  onTiles?: () => void;
  /** A region was chosen, or none is any more. */
  onChosen?: () => void;
  /** A part of the image was drawn, as far as it is; undefined: none any more. */
  onDrawn?: (outline: Outline | undefined) => void;
  canCompare?: boolean;
}

export function renderImage(id: string, hooks: Hooks = {}): RenderImage {
  const canvas = element("canvas", { tabindex: "0", role: "application", "aria-describedby": "image-keys" });
  const waiting = element("p", { class: "waiting" }, "No samples yet.");
  const overlay = new Overlay();
  const frame = element("div", { class: "frame" }, canvas, overlay.canvas, waiting);
  const node = element("div", { class: "picture" });
  const parts = assemble(canvas, node, frame, overlay, { id, ...hooks });
  const unmet = unmetParts((drawn) => {
    overlay.unmet = drawn;
    parts?.viewer.repaint();
  });
  if (parts) frame.after(unmet.node);
  const source = new ImageSource(tilesAddress(id), {
    onImage: (image) => {
      parts?.begin(image);
      hooks.onImage?.(image);
    },
    onTiles: (tiles) => {
      parts?.viewer.putTiles("first", tiles);
      parts?.inspector.refresh();
      hooks.onTiles?.();
      waiting.hidden = true;
      canvas.dataset.updates = `${Number(canvas.dataset.updates ?? 0) + 1}`;
      canvas.dataset.tiles = `${Number(canvas.dataset.tiles ?? 0) + tiles.length}`;
    },
  });
  return {
    node,
    viewer: parts?.viewer,
    overlay,
    show: (render) => {
      parts?.measure(measured(render));
      parts?.learned.show(render);
      unmet.show(render);
      canvas.setAttribute("aria-label", `Image of ${render.name}, ${samplesText(render)}`);
      setText(waiting, whyNothingIsShown(render));
    },
    refresh: () => { source.request(); },
    chosen: () => parts?.viewer.look.chosen,
    close: () => {
      source.close();
      parts?.inspector.close();
      parts?.learned.close();
      parts?.viewer.close();
    },
  };
}

interface Parts {
  viewer: Viewer;
  inspector: Inspector;
  learned: LearnedLightView;
  begin: (image: TiledImage) => void;
  measure: (measured: Measured) => void;
}

/** Puts tools, image, legend and inspector into `node`; a sentence only, where images can't be shown. */
function assemble(canvas: HTMLCanvasElement, node: HTMLElement, frame: HTMLElement, overlay: Overlay, hooks: Hooks & { id: string }): Parts | undefined {
  const strip = legend();
  const range = rangeForm((scale) => { viewer.setRange(scale); });
  let refresh = (): void => undefined;
  let remember = (): void => undefined;
  const zoom = element("p", { class: "zoom" });
  let hasImage = false;
  let viewer: Viewer;
  try {
    viewer = new Viewer(canvas, {
      onLook: () => { refresh(); },
      onPaint: () => { overlay.paint({ image: viewer.images[side()], show: viewer.look.show, placement: viewer.placement, width: canvas.width, height: canvas.height, side: side() }); },
      onPlacement: ({ scale }) => {
        remember();
        // Without one, a single pixel stands for the film.
        setText(zoom, hasImage ? `${Number((100 * scale).toPrecision(3))} %` : "");
      },
    });
  } catch (error) {
    node.append(element("p", { class: "problem", role: "alert" }, error instanceof Error ? error.message : String(error)));
    return undefined;
  }
  let wanted = recall(viewer, hooks.canCompare ?? false);
  remember = rememberer(viewer);
  const looked: { pixel?: Region } = {};
  const side = (): "first" | "second" => (viewer.look.side === "second" ? "second" : "first");
  const ask = (region: Region): Promise<RegionReading> | undefined => (side() === "first" ? readRegion(hooks.id, region) : undefined);
  const numbers = inspector(() => viewer.images[side()], () => viewer.look.measured, ask);
  const tools = controls(viewer, { neutral: () => neutralOf(viewer, looked.pixel), canCompare: hooks.canCompare ?? false, picture: node });
  refresh = () => {
    tools.refresh();
    strip.show(viewer.look);
    range.show(viewer.look);
    numbers.refresh();
    remember();
  };
  const learned = learnedLightView(hooks.id);
  const listener = gestureListener(viewer, numbers, looked, hooks, { remember, pixel: learned.showPixel });
  listenToGestures(viewer, tools.drawing, listener);
  frame.append(zoom);
  node.append(tools.node, frame, strip.node, range.node, element("p", { id: "image-keys", class: "visually-hidden" }, keys), numbers.node, learned.node);
  return {
    viewer,
    inspector: numbers,
    learned,
    measure: (now) => { measureAs(viewer, now); },
    begin: (image) => {
      try {
        hasImage = true;
        viewer.setImage("first", image);
        if (wanted.placement) viewer.place(wanted.placement);
        if (wanted.chosen) listener.onRegion(clipped(wanted.chosen, image));
        wanted = {};
      } catch (error) {
        announce(String(error));
        node.prepend(element("p", { class: "problem", role: "alert" }, error instanceof Error ? error.message : String(error)));
      }
    },
  };
}

/** Changes what is shown where it is another quantity, or its mean is known. */
function measureAs(viewer: Viewer, now: Measured): void {
  const { measured: before } = viewer.look;
  if (before.unit !== now.unit || before.mean !== now.mean) viewer.change({ measured: now });
}

/** What should look white: the chosen region, or the pixel looked at. */
function neutralOf({ look, images }: Viewer, pixel: Region | undefined): Triple | undefined {
  const region = look.chosen ?? pixel;
  return region && images.first?.read(region)?.xyz;
}

/** What is told of a pixel that is looked at, and of a region, line or polygon that is drawn. */
function gestureListener(viewer: Viewer, numbers: Inspector, looked: { pixel?: Region }, hooks: Hooks, told: { remember: () => void; pixel: LearnedLightView["showPixel"] }): GestureListener {
  return {
    onPixel: ({ x, y }) => {
      looked.pixel = { x, y, width: 1, height: 1 };
      numbers.showPixel({ x, y });
      told.pixel({ x, y });
    },
    onRegion: (region) => {
      viewer.choose(region);
      numbers.showRegion(region);
      told.remember();
      hooks.onChosen?.();
      hooks.onDrawn?.(region && { name: "", kind: "rectangle", points: [[region.x, region.y], [region.x + region.width, region.y + region.height]] });
    },
    onPoints: (kind, points) => { hooks.onDrawn?.(points && { name: "", kind, points }); },
  };
}
