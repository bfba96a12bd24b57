/** Where the film lies on the canvas: zoom and pan. Pure; the canvas is measured in device pixels. */

export interface Placement {
  /** Canvas pixels per film pixel. */
  scale: number;
  /** The film's point in the middle of the canvas, pixels. */
  x: number;
  y: number;
}

export interface Size {
  width: number;
  height: number;
}

export interface Point {
  x: number;
  y: number;
}

const largestScale = 128;

/** The whole film, in the middle. Small films are enlarged by halves, for pixels that look alike. */
export function fitted(film: Size, canvas: Size): Placement {
  const scale = Math.min(canvas.width / film.width, canvas.height / film.height);
  return { scale: scale > 1 ? Math.floor(2 * scale) / 2 : scale, x: film.width / 2, y: film.height / 2 };
}

/** Zooms by a factor so that the film's point under `at` (canvas pixels) stays there. */
export function zoomed(placement: Placement, factor: number, at: Point, film: Size, canvas: Size): Placement {
  const scale = boundedScale(placement.scale * factor, film, canvas);
  const before = filmPoint(placement, at, canvas);
  return kept({ scale, x: before.x - (at.x - canvas.width / 2) / scale, y: before.y - (at.y - canvas.height / 2) / scale }, film, canvas);
}

/** Moves the film by canvas pixels. */
export function panned(placement: Placement, by: Point, film: Size, canvas: Size): Placement {
  return kept({ ...placement, x: placement.x - by.x / placement.scale, y: placement.y - by.y / placement.scale }, film, canvas);
}

/** The middle of the canvas never leaves the film, so that it cannot get lost. */
export function kept(placement: Placement, film: Size, canvas: Size): Placement {
  return {
    scale: boundedScale(placement.scale, film, canvas),
    x: Math.min(film.width, Math.max(0, placement.x)),
    y: Math.min(film.height, Math.max(0, placement.y)),
  };
}

function boundedScale(scale: number, film: Size, canvas: Size): number {
  return Math.min(largestScale, Math.max(Math.min(fitted(film, canvas).scale, 1) / 2, scale));
}

export function filmPoint(placement: Placement, at: Point, canvas: Size): Point {
  return {
    x: placement.x + (at.x - canvas.width / 2) / placement.scale,
    y: placement.y + (at.y - canvas.height / 2) / placement.scale,
  };
}

/** Which level of the pyramid has about one texel for a canvas pixel. */
export function levelFor(scale: number, levels: number): number {
  return Math.max(0, Math.min(levels - 1, Math.round(-Math.log2(scale))));
}
