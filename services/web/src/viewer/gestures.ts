/** Pointer, wheel and keys on the image: pan, zoom, look at a pixel, choose a region. */
import { clipped, type Region } from "../image/tiled_image.ts";
import type { Kind } from "../measure/outlines.ts";
import type { Point } from "../image/placement.ts";
import type { Viewer } from "./viewer.ts";

export interface GestureListener {
  /** The pixel looked at. */
  onPixel: (pixel: Point) => void;
  /** A dragged region; undefined: none any more. */
  onRegion: (region: Region | undefined) => void;
  /** Points of a line or polygon that is drawn, as far as it is; undefined: none any more. */
  onPoints: (kind: Kind, points: number[][] | undefined) => void;
}

const wheelStep = 1.0015;
const keyStep = 1.4;
const keyPan_px = 64;

/** `drawing`: what a drag or clicks draw; with Shift a drag chooses a region in any case; else it pans. */
export function listenToGestures(viewer: Viewer, drawing: () => Kind | undefined, listener: GestureListener): void {
  const { canvas } = viewer;
  const down = new Map<number, Point>();
  const drawn = drawer(viewer, listener);

  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    down.set(event.pointerId, { x: event.clientX, y: event.clientY });
    const kind = event.shiftKey ? "rectangle" : drawing();
    drawn.begin(kind, viewer.pixelAt(event.clientX, event.clientY), cornerAt(event, viewer));
    listener.onPixel(viewer.pixelAt(event.clientX, event.clientY));
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = down.get(event.pointerId);
    if (!before) {
      listener.onPixel(viewer.pixelAt(event.clientX, event.clientY));
      return;
    }
    const now = { x: event.clientX, y: event.clientY };
    if (drawn.kind()) drawn.moveTo(viewer.pixelAt(now.x, now.y));
    else drag(viewer, down, event.pointerId, now);
    down.set(event.pointerId, now);
  });
  const up = (event: PointerEvent): void => {
    down.delete(event.pointerId);
    drawn.end();
  };
  canvas.addEventListener("pointerup", up);
  canvas.addEventListener("pointercancel", up);
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      viewer.zoom(wheelStep ** -event.deltaY, viewer.toCanvas(event.clientX, event.clientY));
    },
    { passive: false },
  );
  canvas.addEventListener("dblclick", () => {
    if (drawing() === "polygon") drawn.endPolygon();
    else if (!drawing()) viewer.fit();
  });
  listenToKeys(viewer, drawing, drawn, listener);
}

/** A region, line or polygon, from its first corner on; by pointer or by keys. */
interface Drawer {
  /** What is being drawn. */
  kind: () => Kind | undefined;
  /** `corner`: of a polygon, which lies between pixels. */
  begin: (kind: Kind | undefined, pixel: Point, corner: number[]) => void;
  moveTo: (pixel: Point) => void;
  end: () => void;
  /** The next corner begins another one. */
  endPolygon: () => void;
  forget: () => void;
}

function drawer(viewer: Viewer, listener: GestureListener): Drawer {
  let start: { kind: Kind; at: Point } | undefined;
  let corners: number[][] = [];
  return {
    kind: () => start?.kind,
    begin: (kind, pixel, corner) => {
      start = kind && { kind, at: inFilm(pixel, viewer) };
      if (kind === "polygon" && corner.join() !== corners.at(-1)?.join()) listener.onPoints(kind, (corners = [...corners, corner]));
    },
    moveTo: (pixel) => {
      if (start?.kind === "rectangle") listener.onRegion(between(start.at, pixel, viewer));
      else if (start?.kind === "line") listener.onPoints("line", [start.at, inFilm(pixel, viewer)].map(({ x, y }) => [x, y]));
    },
    end: () => { start = undefined; },
    endPolygon: () => { corners = []; },
    forget: () => {
      start = undefined;
      corners = [];
      listener.onPoints("polygon", undefined);
      listener.onRegion(undefined);
    },
  };
}

/** The nearest corner between pixels: whole numbers are what people read again. */
function cornerAt(event: PointerEvent, viewer: Viewer): number[] {
  const { x, y } = viewer.pointAt(event.clientX, event.clientY);
  const { width, height } = viewer.images.first ?? { width: 1, height: 1 };
  return [Math.min(width, Math.max(0, Math.round(x))), Math.min(height, Math.max(0, Math.round(y)))];
}

function inFilm({ x, y }: Point, viewer: Viewer): Point {
  return clipped({ x, y, width: 1, height: 1 }, viewer.images.first ?? { width: 1, height: 1 });
}

/** One finger or the mouse pans, two fingers pan and zoom. */
function drag(viewer: Viewer, down: ReadonlyMap<number, Point>, id: number, now: Point): void {
  const before = down.get(id);
  if (!before) return;
  const ratio = viewer.canvas.width / Math.max(1, viewer.canvas.clientWidth);
  const share = ratio / down.size;
  viewer.pan({ x: (now.x - before.x) * share, y: (now.y - before.y) * share });
  const other = [...down].find(([otherId]) => otherId !== id)?.[1];
  if (!other) return;
  const factor = Math.hypot(now.x - other.x, now.y - other.y) / Math.max(1, Math.hypot(before.x - other.x, before.y - other.y));
  viewer.zoom(factor, viewer.toCanvas((now.x + other.x) / 2, (now.y + other.y) / 2));
}

/** Arrows move the pixel that is looked at, with Shift they pan; the rest is in the canvas's description. */
function listenToKeys(viewer: Viewer, drawing: () => Kind | undefined, drawn: Drawer, listener: GestureListener): void {
  let pixel: Point | undefined;
  const corner = (): void => {
    const kind = drawing();
    const at = (pixel ??= next({ x: 0, y: 0 }));
    // The second corner ends a region and a line.
    if (drawn.kind() && kind !== "polygon") drawn.end();
    else drawn.begin(kind, at, [at.x, at.y]);
    drawn.moveTo(at);
    listener.onPixel(at);
  };
  const arrows: Record<string, Point> = {
    ArrowLeft: { x: -1, y: 0 }, ArrowRight: { x: 1, y: 0 }, ArrowUp: { x: 0, y: -1 }, ArrowDown: { x: 0, y: 1 },
  };
  const others: Record<string, () => void> = {
    "+": () => { viewer.zoom(keyStep); },
    "=": () => { viewer.zoom(keyStep); },
    "-": () => { viewer.zoom(1 / keyStep); },
    "0": () => { viewer.fit(); },
    "1": () => { viewer.zoom(1 / viewer.placement.scale); },
    Enter: corner,
    Escape: () => { drawn.forget(); },
  };
  viewer.canvas.addEventListener("keydown", (event) => {
    if (isShortcut(event)) return;
    const arrow = arrows[event.key];
    const other = others[event.key];
    if (!arrow && !other) return;
    event.preventDefault();
    other?.();
    if (arrow && event.shiftKey) viewer.pan({ x: -keyPan_px * arrow.x, y: -keyPan_px * arrow.y });
    else if (arrow) {
      listener.onPixel((pixel = next(arrow)));
      drawn.moveTo(pixel);
    }
  });
  const next = (by: Point): Point => {
    const from = pixel ?? { x: Math.floor(viewer.placement.x), y: Math.floor(viewer.placement.y) };
    return clipped({ x: from.x + by.x, y: from.y + by.y, width: 1, height: 1 }, viewer.images.first ?? { width: 1, height: 1 });
  };
}

/** Of the browser. */
function isShortcut(event: KeyboardEvent): boolean {
  return event.ctrlKey || event.metaKey || event.altKey;
}

function between(a: Point, b: Point, viewer: Viewer): Region {
  const corner = { x: Math.min(a.x, b.x), y: Math.min(a.y, b.y) };
  const region = { ...corner, width: Math.abs(a.x - b.x) + 1, height: Math.abs(a.y - b.y) + 1 };
  return clipped(region, viewer.images.first ?? { width: 1, height: 1 });
}
