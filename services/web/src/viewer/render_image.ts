/** A render's image with its tools: fetched tile by tile, followed as it grows. */
import { announce, element, setText } from "../dom.ts";
import type { Film, Region } from "../image/film.ts";
import { type Measured, measured } from "../image/look.ts";
import { FilmSource } from "../image/film_source.ts";
import { readRegion, tilesAddress } from "../service/client.ts";
import { hasEnded, type RegionReading, type Render } from "../service/types.ts";
import { samplesText } from "../views/progress_bar.ts";
import { controls } from "./controls.ts";
import { listenToGestures } from "./gestures.ts";
import { inspector } from "./inspector.ts";
import { legend } from "./legend.ts";
import { Viewer } from "./viewer.ts";

const keys = "Arrow keys move from pixel to pixel, with Shift they pan. Plus and minus zoom, 1 shows pixel for pixel, 0 the whole image.";

export interface RenderImage {
  node: HTMLElement;
  /** Undefined where this browser can't show images. */
  viewer: Viewer | undefined;
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

/** `onFilm`: the first tiles are there; `onChosen`: a region was chosen, or none is any more. */
export function renderImage(id: string, hooks: { onFilm?: (film: Film) => void; onChosen?: () => void; canCompare?: boolean } = {}): RenderImage {
  const canvas = element("canvas", { tabindex: "0", role: "application", "aria-describedby": "image-keys" });
  const waiting = element("p", { class: "waiting" }, "No samples yet.");
  const frame = element("div", { class: "frame" }, canvas, waiting);
  const node = element("div", { class: "picture" });
  const parts = assemble(canvas, node, frame, { id, ...hooks });
  const source = new FilmSource(tilesAddress(id), {
    onFilm: (film) => {
      parts?.begin(film);
      hooks.onFilm?.(film);
    },
    onTiles: (tiles) => {
      parts?.viewer.putTiles("first", tiles);
      parts?.inspector.refresh();
      waiting.hidden = true;
      canvas.dataset.updates = `${Number(canvas.dataset.updates ?? 0) + 1}`;
      canvas.dataset.tiles = `${Number(canvas.dataset.tiles ?? 0) + tiles.length}`;
    },
  });
  return {
    node,
    viewer: parts?.viewer,
    show: (render) => {
      parts?.measure(measured(render));
      canvas.setAttribute("aria-label", `Image of ${render.name}, ${samplesText(render)}`);
      setText(waiting, whyNothingIsShown(render));
    },
    refresh: () => { source.request(); },
    chosen: () => parts?.viewer.look.chosen,
    close: () => {
      source.close();
      parts?.inspector.close();
      parts?.viewer.close();
    },
  };
}

interface Parts {
  viewer: Viewer;
  inspector: ReturnType<typeof inspector>;
  begin: (film: Film) => void;
  measure: (measured: Measured) => void;
}

/** Puts tools, image, legend and inspector into `node`; a sentence only, where images can't be shown. */
function assemble(canvas: HTMLCanvasElement, node: HTMLElement, frame: HTMLElement, hooks: { id: string; onChosen?: () => void; canCompare?: boolean }): Parts | undefined {
  const strip = legend();
  let refresh = (): void => undefined;
  const zoom = element("p", { class: "zoom" });
  let viewer: Viewer;
  try {
    viewer = new Viewer(canvas, {
      onLook: () => { refresh(); },
      onPlacement: ({ scale }) => { setText(zoom, `${Number((100 * scale).toPrecision(3))} %`); },
    });
  } catch (error) {
    node.append(element("p", { class: "problem", role: "alert" }, error instanceof Error ? error.message : String(error)));
    return undefined;
  }
  const looked: { pixel?: Region } = {};
  const side = (): "first" | "second" => (viewer.look.side === "second" ? "second" : "first");
  const ask = (region: Region): Promise<RegionReading> | undefined => (side() === "first" ? readRegion(hooks.id, region) : undefined);
  const numbers = inspector(() => viewer.films[side()], () => viewer.look.measured, ask);
  const tools = controls(viewer, {
    neutral: () => {
      const region = viewer.look.chosen ?? looked.pixel;
      return region && viewer.films.first?.read(region)?.xyz;
    },
    canCompare: hooks.canCompare ?? false,
  });
  refresh = () => {
    tools.refresh();
    strip.show(viewer.look);
    numbers.refresh();
  };
  listenToGestures(viewer, tools.choosing, {
    onPixel: ({ x, y }) => {
      looked.pixel = { x, y, width: 1, height: 1 };
      numbers.showPixel({ x, y });
    },
    onRegion: (region) => {
      viewer.choose(region);
      numbers.showRegion(region);
      hooks.onChosen?.();
    },
  });
  frame.append(zoom);
  node.append(tools.node, frame, strip.node, element("p", { id: "image-keys", class: "visually-hidden" }, keys), numbers.node);
  return {
    viewer,
    inspector: numbers,
    measure: (now) => {
      const { measured: before } = viewer.look;
      if (before.unit !== now.unit || before.mean !== now.mean) viewer.change({ measured: now });
    },
    begin: (film) => {
      try {
        viewer.setFilm("first", film);
      } catch (error) {
        announce(String(error));
        node.prepend(element("p", { class: "problem", role: "alert" }, error instanceof Error ? error.message : String(error)));
      }
    },
  };
}
