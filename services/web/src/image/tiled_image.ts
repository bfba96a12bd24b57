/** An image that grows, tile by tile, and what can be read off it. No I/O. */
import type { Region } from "../service/types.ts";
import type { Tile, TileAnswer } from "./tiles.ts";

export type { Region };

/** Means over the pixels of a region that have samples. */
export interface Reading {
  region: Region;
  xyz: [number, number, number];
  /** Of the mean Y, taking pixels as independent of each other; NaN where unknown. The service knows better. */
  standardError: number;
  /** Fewest and most samples of any pixel. */
  samples: [number, number];
  /** Of the tiles that the region touches. */
  invalid_samples: number;
  /** Pixels with samples. */
  pixels: number;
}

/** Looked at again with every update: must take milliseconds. */
const somePixels = 50_000;

export class TiledImage {
  readonly width: number;
  readonly height: number;
  readonly tileSize: number;
  readonly tiles = new Map<number, Tile>();
  readonly #columns: number;

  constructor(width: number, height: number, tileSize: number) {
    this.width = width;
    this.height = height;
    this.tileSize = tileSize;
    this.#columns = Math.ceil(width / tileSize);
  }

  put(tile: Tile): void {
    this.tiles.set(tile.index, tile);
  }

  /** X, Y, Z, standard error and samples of one pixel; undefined outside, and where there are no samples yet. */
  pixel(x: number, y: number): { values: Float32Array; tile: Tile } | undefined {
    if (x < 0 || y < 0 || x >= this.width || y >= this.height) return undefined;
    const tile = this.tiles.get(Math.floor(y / this.tileSize) * this.#columns + Math.floor(x / this.tileSize));
    if (!tile || tile.samples === 0) return undefined;
    const at = 4 * ((y - tile.y) * tile.width + (x - tile.x));
    return { values: tile.pixels.subarray(at, at + 4), tile };
  }

  /** What a region holds; undefined where it has no samples. */
  read(region: Region): Reading | undefined {
    let [sumX, sumY, sumZ, variance, pixels] = [0, 0, 0, 0, 0];
    const seen = new Set<Tile>();
    for (let y = region.y; y < region.y + region.height; y += 1) {
      for (let x = region.x; x < region.x + region.width; x += 1) {
        const found = this.pixel(x, y);
        if (!found) continue;
        const [X = 0, Y = 0, Z = 0, error = 0] = found.values;
        sumX += X;
        sumY += Y;
        sumZ += Z;
        variance += error * error;
        pixels += 1;
        seen.add(found.tile);
      }
    }
    if (pixels === 0) return undefined;
    const [fewest, most] = fewestAndMost(seen);
    return {
      region,
      xyz: [sumX / pixels, sumY / pixels, sumZ / pixels],
      standardError: fewest > 1 ? Math.sqrt(variance) / pixels : NaN,
      samples: [fewest, most],
      invalid_samples: [...seen].reduce((total, tile) => total + tile.invalid_samples, 0),
      pixels,
    };
  }

  /** The largest of a number of tiles, at least 1. */
  most(of: (tile: Tile) => number): number {
    let most = 1;
    for (const tile of this.tiles.values()) most = Math.max(most, of(tile));
    return most;
  }

  /** One of the four values of pixels here and there: enough to choose an exposure or a scale by. */
  *some(channel: number): Generator<number> {
    const step = Math.max(3, Math.ceil(Math.sqrt((this.width * this.height) / somePixels)));
    for (const { pixels, width, height } of this.tiles.values()) {
      for (let y = Math.min(1, height - 1); y < height; y += step) {
        for (let x = Math.min(1, width - 1); x < width; x += step) yield pixels[4 * (y * width + x) + channel] ?? 0;
      }
    }
  }

  /** About how bright it is, cd/m2: the logarithmic mean of Y; 0 where all is dark. */
  logarithmicMean(): number {
    let sum = 0;
    let count = 0;
    for (const Y of this.some(1)) {
      if (Y <= 0) continue;
      sum += Math.log(Y);
      count += 1;
    }
    return count > 0 ? Math.exp(sum / count) : 0;
  }
}

/** The part of a region that lies in the film, at least one pixel of it. */
export function clipped(region: Region, film: { width: number; height: number }): Region {
  const x = Math.min(Math.max(0, region.x), film.width - 1);
  const y = Math.min(Math.max(0, region.y), film.height - 1);
  return {
    x,
    y,
    width: Math.max(1, Math.min(region.x + region.width, film.width) - x),
    height: Math.max(1, Math.min(region.y + region.height, film.height) - y),
  };
}

/** The film of an answer that has all of its tiles. */
export function tiledImageOf({ width, height, tileSize, tiles }: TileAnswer): TiledImage {
  const image = new TiledImage(width, height, tileSize);
  for (const tile of tiles) image.put(tile);
  return image;
}

/** Samples of tiles, one by one: a film may have more tiles than a call may have arguments. */
function fewestAndMost(tiles: Iterable<Tile>): [number, number] {
  let [fewest, most] = [Infinity, 0];
  for (const { samples } of tiles) [fewest, most] = [Math.min(fewest, samples), Math.max(most, samples)];
  return [fewest, most];
}
