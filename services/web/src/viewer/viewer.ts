/** An image on a canvas: one or two images, how they are looked at, and where they lie. */
import { GlImage } from "../image/gl_image.ts";
import { GlPainter } from "../image/gl_painter.ts";
import type { TiledImage, Region } from "../image/tiled_image.ts";
import { autoExposure, type Look, scaleOf } from "../image/look.ts";
import type { Scale } from "../image/colour_maps.ts";
import { whites } from "../image/colour.ts";
import { filmPoint, fitted, kept, panned, type Placement, type Point, zoomed } from "../image/placement.ts";
import type { Tile } from "../image/tiles.ts";

export type Side = "first" | "second";

export interface ViewerListener {
  /** The look or its scale changed by itself, as with the first light of an image. */
  onLook: () => void;
  onPlacement: (placement: Placement) => void;
  /** The canvas was painted: what lies over it follows. */
  onPaint: () => void;
}

export class Viewer {
  readonly canvas: HTMLCanvasElement;
  readonly images: { first?: TiledImage; second?: TiledImage } = {};
  look: Look = {
    show: "colour", exposure: 1, white: whites.D65, tone: "reinhard", warnClipped: false, warnGamut: false, workers: false,
    side: "first", wipe: 0.5, scale: { low: 0, high: 1, logarithmic: false }, ranges: {}, chosen: undefined,
    measured: { quantity: "Y", unit: "", mean: 0 },
  };
  /** Until somebody zooms or pans, the whole film is in sight. */
  isFitted = true;
  /** Until somebody moves the slider, the exposure follows the image. */
  isAuto = true;
  readonly #painter: GlPainter;
  readonly #listener: ViewerListener;
  readonly #observer: ResizeObserver;
  #placement: Placement = { scale: 1, x: 0, y: 0 };
  #frame = 0;

  /** Throws Error, fit to be shown, where images can't be painted. */
  constructor(canvas: HTMLCanvasElement, listener: ViewerListener) {
    this.canvas = canvas;
    this.#listener = listener;
    this.#painter = new GlPainter(canvas);
    this.#observer = new ResizeObserver(() => {
      this.#resize();
    });
    this.#observer.observe(canvas);
  }

  /** Begins to show an image, with the tiles that it has. */
  setImage(side: Side, image: TiledImage): void {
    this.#painter[side]?.delete();
    this.#painter[side] = new GlImage(this.#painter.gl, image.width, image.height, image.tileSize);
    this.images[side] = image;
    if (side === "first") this.fit();
    this.putTiles(side, [...image.tiles.values()]);
  }

  putTiles(side: Side, tiles: readonly Tile[]): void {
    for (const tile of tiles) this.#painter[side]?.put(tile);
    if (side === "first") this.#follow();
    this.#request();
  }

  showWorkers(byTile: ReadonlyMap<number, number>): void {
    this.#painter.first?.showWorkers(byTile);
    this.#request();
  }

  change(look: Partial<Look>): void {
    if (look.exposure !== undefined) this.isAuto = false;
    Object.assign(this.look, look);
    if (look.show !== undefined || look.ranges !== undefined) this.#rescale();
    this.#request();
    this.#listener.onLook();
  }

  /** Of this view's colour map; undefined: by the image itself. */
  setRange(scale: Scale | undefined): void {
    this.change({ ranges: { ...this.look.ranges, [this.look.show]: scale } });
  }

  /** Exposes by the image itself, from now on until somebody says otherwise. */
  exposeByImage(): void {
    this.isAuto = true;
    this.#follow();
    this.#request();
    this.#listener.onLook();
  }

  get placement(): Placement {
    return this.#placement;
  }

  /** As somebody had it. */
  place(placement: Placement): void {
    this.isFitted = false;
    this.#place(kept(placement, this.#film, this.#size));
  }

  fit(): void {
    this.isFitted = true;
    this.#place(fitted(this.#film, this.#size));
  }

  zoom(factor: number, at: Point = { x: this.#size.width / 2, y: this.#size.height / 2 }): void {
    this.isFitted = false;
    this.#place(zoomed(this.#placement, factor, at, this.#film, this.#size));
  }

  pan(by: Point): void {
    this.isFitted = false;
    this.#place(panned(this.#placement, by, this.#film, this.#size));
  }

  /** The film's pixel under a point of the window; it may lie outside the film. */
  pixelAt(clientX: number, clientY: number): Point {
    const point = this.pointAt(clientX, clientY);
    return { x: Math.floor(point.x), y: Math.floor(point.y) };
  }

  /** The film's point under a point of the window, in pixels and parts of these. */
  pointAt(clientX: number, clientY: number): Point {
    return filmPoint(this.#placement, this.toCanvas(clientX, clientY), this.#size);
  }

  /** From a point of the window to pixels of the canvas. */
  toCanvas(clientX: number, clientY: number): Point {
    const box = this.canvas.getBoundingClientRect();
    const ratio = this.canvas.width / Math.max(1, box.width);
    return { x: (clientX - box.left) * ratio, y: (clientY - box.top) * ratio };
  }

  choose(region: Region | undefined): void {
    this.look.chosen = region;
    this.#request();
  }

  /** What lies over the image changed. */
  repaint(): void {
    this.#request();
  }

  close(): void {
    this.#observer.disconnect();
    cancelAnimationFrame(this.#frame);
    this.#painter.gl.getExtension("WEBGL_lose_context")?.loseContext();
  }

  get #film(): { width: number; height: number } {
    return this.images.first ?? { width: 1, height: 1 };
  }

  get #size(): { width: number; height: number } {
    return { width: this.canvas.width, height: this.canvas.height };
  }

  #follow(): void {
    const image = this.images.first;
    if (!image) return;
    if (this.isAuto) this.look.exposure = autoExposure(image);
    this.#rescale();
    this.#listener.onLook();
  }

  #rescale(): void {
    const { show, ranges } = this.look;
    if (this.images.first) this.look.scale = ranges[show] ?? scaleOf(show, this.images.first);
  }

  #place(placement: Placement): void {
    this.#placement = placement;
    this.#listener.onPlacement(placement);
    this.#request();
  }

  #resize(): void {
    const { clientWidth, clientHeight } = this.canvas;
    this.canvas.width = Math.max(1, Math.round(clientWidth * devicePixelRatio));
    this.canvas.height = Math.max(1, Math.round(clientHeight * devicePixelRatio));
    if (this.isFitted) this.fit();
    // At once: a canvas that changed its size is empty until it is painted.
    this.#paint();
  }

  #request(): void {
    this.#frame ||= requestAnimationFrame(() => {
      this.#paint();
    });
  }

  #paint(): void {
    this.#frame = 0;
    this.#painter.paint(this.look, this.#placement);
    this.#listener.onPaint();
    this.canvas.dataset.frames = `${Number(this.canvas.dataset.frames ?? 0) + 1}`;
  }
}
