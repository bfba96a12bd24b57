/** What lies over the image: where light may be missing, isolines with their values, outlines that are measured, and the values of pixels when they are large. */
import { element } from "../dom.ts";
import { formatValue } from "../format.ts";
import type { TiledImage } from "../image/tiled_image.ts";
import type { Show } from "../image/look.ts";
import type { Placement, Point } from "../image/placement.ts";
import type { Isolines, Outline, UnmetPart } from "../service/types.ts";
import type { Side } from "./viewer.ts";

/** Edge of a pixel on the screen from which its value has room, in pixels of the style sheet. */
const roomForValue_px = 44;
/** A shorter isoline has no room for its value. */
const roomForLabel_px = 90;
const labelsPerLevel = 3;
/** What a label takes, of style sheet pixels: no two stand closer. */
const labelRoom_px = { x: 56, y: 16 };

const ink = "#ffffff";
const halo = "rgb(0 0 0 / 75%)";
const drawn = "#ffd166";
const tint = "rgb(255 209 102 / 20%)";
/** Between lines of a hatched part, pixels of the style sheet. */
const hatch_px = 10;

export interface Seen {
  image: TiledImage | undefined;
  show: Show;
  placement: Placement;
  /** Of the canvas, device pixels. */
  width: number;
  height: number;
  side: Side;
}

interface Label {
  text: string;
  place: Point;
}

export class Overlay {
  readonly canvas = element("canvas", { class: "overlay", "aria-hidden": "true" });
  isolines: Isolines | undefined;
  outlines: readonly Outline[] = [];
  /** Sources of glare. */
  marks: readonly Outline[] = [];
  /** What is being drawn. */
  draft: Outline | undefined;
  /** Where light of the first side's render may be missing. */
  unmet: readonly UnmetPart[] = [];
  #isEmpty = true;

  paint(seen: Seen): void {
    const values = showsValues(seen) ? seen.image : undefined;
    const outlines = this.draft ? [...this.outlines, this.draft] : this.outlines;
    const unmet = seen.side === "first" ? this.unmet : [];
    const isEmpty = !values && !this.isolines && outlines.length + this.marks.length + unmet.length === 0;
    if (isEmpty && this.#isEmpty) return;
    this.#isEmpty = isEmpty;
    // Also clears it.
    this.canvas.width = seen.width;
    this.canvas.height = seen.height;
    const context = this.canvas.getContext("2d");
    if (!context) return;
    paintHatched(context, unmet, seen);
    this.#draw(context, seen, values, outlines);
  }

  #draw(context: CanvasRenderingContext2D, seen: Seen, values: TiledImage | undefined, outlines: readonly Outline[]): void {
    const ratio = devicePixelRatio;
    Object.assign(context, { font: `${12 * ratio}px system-ui, sans-serif`, textAlign: "center", textBaseline: "middle", lineJoin: "round" });
    const at = (x: number, y: number): Point => onCanvas({ x, y }, seen);
    if (values) paintValues(context, values, seen, ratio);
    const labels: Label[] = [];
    for (const { level, lines } of this.isolines?.isolines ?? []) {
      const paths = lines.map((line) => line.map(([x = 0, y = 0]) => at(x, y)));
      for (const path of paths) stroke(context, path, ratio, ink, false);
      labels.push(...labelsOf(`${Number(formatValue(level, 4))}`, paths, labels, seen, ratio));
    }
    // Over all lines.
    for (const { text, place } of labels) label(context, text, place, ratio);
    for (const mark of this.marks) paintOutline(context, mark, at, ratio, drawn);
    for (const outline of outlines) paintOutline(context, outline, at, ratio, outline === this.draft ? drawn : ink);
  }
}

function showsValues({ show, placement }: Seen): boolean {
  return placement.scale >= roomForValue_px * devicePixelRatio && (show === "luminance" || show === "error" || show === "colour");
}

/** From a point of the film to pixels of the canvas. */
export function onCanvas({ x, y }: Point, { placement, width, height }: Pick<Seen, "placement" | "width" | "height">): Point {
  return { x: (x - placement.x) * placement.scale + width / 2, y: (y - placement.y) * placement.scale + height / 2 };
}

/** Lines across all of them, and a tint for those that are smaller than the lines are apart. */
function paintHatched(context: CanvasRenderingContext2D, parts: readonly UnmetPart[], seen: Seen): void {
  if (parts.length === 0) return;
  context.save();
  context.beginPath();
  for (const { x, y, width, height } of parts) {
    const corner = onCanvas({ x, y }, seen);
    context.rect(corner.x, corner.y, width * seen.placement.scale, height * seen.placement.scale);
  }
  context.fillStyle = tint;
  context.fill();
  context.clip();
  context.beginPath();
  for (let x = -seen.height; x < seen.width; x += hatch_px * devicePixelRatio) {
    context.moveTo(x, seen.height);
    context.lineTo(x + seen.height, 0);
  }
  for (const [width, style] of [[2.5, halo], [1, drawn]] as const) {
    context.lineWidth = width * devicePixelRatio;
    context.strokeStyle = style;
    context.stroke();
  }
  context.restore();
}

function paintValues(context: CanvasRenderingContext2D, image: TiledImage, seen: Seen, ratio: number): void {
  const { placement: { x, y, scale }, width, height } = seen;
  const channel = seen.show === "error" ? 3 : 1;
  for (let row = Math.floor(y - height / 2 / scale); row <= y + height / 2 / scale; row += 1) {
    for (let column = Math.floor(x - width / 2 / scale); column <= x + width / 2 / scale; column += 1) {
      const value = image.pixel(column, row)?.values[channel];
      if (value === undefined) continue;
      label(context, formatValue(value, 3), onCanvas({ x: column + 0.5, y: row + 0.5 }, seen), ratio);
    }
  }
}

/** Places for a value on its longest lines, in sight and clear of other labels; a line without such a place has none. */
function labelsOf(text: string, paths: Point[][], others: readonly Label[], seen: Seen, ratio: number): Label[] {
  const found: Label[] = [];
  const isClear = (place: Point): boolean =>
    place.x > 30 && place.y > 12 && place.x < seen.width - 30 && place.y < seen.height - 12 &&
    ![...others, ...found].some(({ place: { x, y } }) => Math.abs(x - place.x) < labelRoom_px.x * ratio && Math.abs(y - place.y) < labelRoom_px.y * ratio);
  const longest = paths.map((path) => ({ path, length: lengthOf(path) })).filter(({ length }) => length > roomForLabel_px * ratio).sort((a, b) => b.length - a.length);
  for (const { path } of longest.slice(0, labelsPerLevel)) {
    const middle = path.length >> 1;
    const place = [...path.slice(middle), ...path.slice(0, middle)].find(isClear);
    if (place) found.push({ text, place });
  }
  return found;
}

function paintOutline(context: CanvasRenderingContext2D, outline: Outline, at: (x: number, y: number) => Point, ratio: number, colour: string): void {
  const path = cornersOf(outline).map(([x = 0, y = 0]) => at(x, y));
  stroke(context, path, ratio, colour, outline.kind !== "line");
  const mean = (of: (point: Point) => number): number => path.reduce((sum, point) => sum + of(point), 0) / path.length;
  if (outline.name) label(context, outline.name, { x: mean(({ x }) => x), y: mean(({ y }) => y) }, ratio);
}

function cornersOf({ kind, points }: Outline): readonly (readonly number[])[] {
  // A line goes from the middle of its first pixel to that of its last.
  if (kind === "line") return points.map(([x = 0, y = 0]) => [x + 0.5, y + 0.5]);
  if (kind === "polygon") return points;
  const [[x0 = 0, y0 = 0] = [], [x1 = 0, y1 = 0] = []] = points;
  return [[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
}

function stroke(context: CanvasRenderingContext2D, path: readonly Point[], ratio: number, colour: string, closed: boolean): void {
  context.beginPath();
  path.forEach(({ x, y }, index) => { if (index === 0) context.moveTo(x, y); else context.lineTo(x, y); });
  if (closed) context.closePath();
  for (const [width, style] of [[3.5, halo], [1.5, colour]] as const) {
    context.lineWidth = width * ratio;
    context.strokeStyle = style;
    context.stroke();
  }
}

/** Readable on any colour. */
function label(context: CanvasRenderingContext2D, text: string, { x, y }: Point, ratio: number): void {
  context.lineWidth = 3.5 * ratio;
  context.strokeStyle = halo;
  context.strokeText(text, x, y);
  context.fillStyle = ink;
  context.fillText(text, x, y);
}

function lengthOf(path: readonly Point[]): number {
  return path.reduce((sum, { x, y }, index) => {
    const before = path[index - 1];
    return before ? sum + Math.hypot(x - before.x, y - before.y) : sum;
  }, 0);
}
