/** Answers with tiles: the layout in docs/reference/api.md, "Tiles". Pure. */

export interface Tile {
  index: number;
  /** In pixels of the film. */
  x: number;
  y: number;
  width: number;
  height: number;
  samples: number;
  invalid_samples: number;
  revision: number;
  /** X, Y, Z and the standard error of Y of each pixel, row by row. */
  pixels: Float32Array;
}

export interface TileAnswer {
  width: number;
  height: number;
  tileSize: number;
  more: boolean;
  /** The next answer's `since`. */
  cursor: string;
  tiles: Tile[];
}

const magic = 0x3159584e; // "NXY1"
const headerWords = 8;
const tileWords = 4;

/** Throws Error where the bytes are no such answer. */
export function decodeTiles(bytes: ArrayBuffer): TileAnswer {
  if (bytes.byteLength < 4 * headerWords || new Uint32Array(bytes, 0, 1)[0] !== magic) throw new Error("this is no answer with tiles");
  const [width, height, tileSize, count, more, revision, last] = words(bytes, 4, headerWords - 1) as [number, number, number, number, number, number, number];
  const columns = Math.ceil(width / tileSize);
  const tiles: Tile[] = [];
  let offset = 4 * headerWords;
  for (let number = 0; number < count; number += 1) {
    const [index, samples, invalid_samples, changed] = words(bytes, offset, tileWords) as [number, number, number, number];
    const x = (index % columns) * tileSize;
    const y = Math.floor(index / columns) * tileSize;
    const area = { width: Math.min(tileSize, width - x), height: Math.min(tileSize, height - y) };
    const pixels = new Float32Array(bytes, offset + 4 * tileWords, 4 * area.width * area.height);
    tiles.push({ index, x, y, ...area, samples, invalid_samples, revision: changed, pixels });
    offset += 4 * tileWords + pixels.byteLength;
  }
  return { width, height, tileSize, more: more === 1, cursor: `${revision}.${last}`, tiles };
}

function words(bytes: ArrayBuffer, offset: number, count: number): number[] {
  return [...new Uint32Array(bytes, offset, count)];
}

/** One level of a tile's pyramid: `width` x `height` pixels of four floats. */
export interface Level {
  width: number;
  height: number;
  pixels: Float32Array;
}

/** The tile, then means of 2 x 2 pixels of the level before, `count` in all; odd last rows and columns have no share. */
export function pyramid(tile: Level, count: number): Level[] {
  const levels = [tile];
  while (levels.length < count) levels.push(halved(levels.at(-1) ?? tile));
  return levels;
}

function halved(from: Level): Level {
  const width = from.width >> 1;
  const height = from.height >> 1;
  const pixels = new Float32Array(4 * width * height);
  const row = 4 * from.width;
  for (let y = 0; y < height; y += 1) {
    for (let i = 0; i < 4 * width; i += 1) {
      const at = 2 * y * row + 8 * (i >> 2) + (i & 3);
      const sum = (from.pixels[at] ?? 0) + (from.pixels[at + 4] ?? 0) + (from.pixels[at + row] ?? 0) + (from.pixels[at + row + 4] ?? 0);
      pixels[4 * width * y + i] = sum / 4;
    }
  }
  return { width, height, pixels };
}
