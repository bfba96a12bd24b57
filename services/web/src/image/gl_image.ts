/** A film on the graphics processor: its pixels with a pyramid, and a grid with a texel for each tile. */
import { pyramid, type Tile } from "./tiles.ts";

/** Below 32 x 32 pixels for one, nothing is seen of a film any more. */
const mostLevels = 6;

export class GlImage {
  readonly width: number;
  readonly height: number;
  readonly tileSize: number;
  readonly levels: number;
  readonly pixels: WebGLTexture;
  readonly grid: WebGLTexture;
  readonly #gl: WebGL2RenderingContext;
  readonly #columns: number;
  readonly #workers = new Map<number, number>();
  readonly #about = new Map<number, Tile>();

  /** Throws Error where the film is larger than the graphics processor takes. */
  constructor(gl: WebGL2RenderingContext, width: number, height: number, tileSize: number) {
    const largest = gl.getParameter(gl.MAX_TEXTURE_SIZE) as number;
    if (Math.max(width, height) > largest) throw new Error(`This browser shows images up to ${largest} pixels a side; the EXR has all of it.`);
    this.#gl = gl;
    this.width = width;
    this.height = height;
    this.tileSize = tileSize;
    this.#columns = Math.ceil(width / tileSize);
    // A level of one texel for a tile is the last that a tile alone decides, unless it is the whole film.
    const alone = Math.max(width, height) <= tileSize ? Math.log2(Math.max(width, height)) : Math.log2(tileSize);
    this.levels = Math.min(mostLevels, Math.floor(alone) + 1);
    this.pixels = texture(gl, width, height, this.levels);
    this.grid = texture(gl, this.#columns, Math.ceil(height / tileSize), 1);
  }

  put(tile: Tile): void {
    const gl = this.#gl;
    gl.bindTexture(gl.TEXTURE_2D, this.pixels);
    pyramid(tile, this.levels).forEach(({ width, height, pixels }, level) => {
      if (pixels.length === 0) return;
      gl.texSubImage2D(gl.TEXTURE_2D, level, tile.x >> level, tile.y >> level, width, height, gl.RGBA, gl.FLOAT, pixels);
    });
    this.#about.set(tile.index, tile);
    this.#putAbout(tile.index);
  }

  /** Who works on which tile, as numbers from 1. */
  showWorkers(byTile: ReadonlyMap<number, number>): void {
    const changed = new Set([...this.#workers.keys(), ...byTile.keys()]);
    this.#workers.clear();
    for (const [tile, worker] of byTile) this.#workers.set(tile, worker);
    for (const tile of changed) this.#putAbout(tile);
  }

  delete(): void {
    this.#gl.deleteTexture(this.pixels);
    this.#gl.deleteTexture(this.grid);
  }

  #putAbout(index: number): void {
    const gl = this.#gl;
    const tile = this.#about.get(index);
    const texel = Float32Array.of(tile?.samples ?? 0, tile?.invalid_samples ?? 0, this.#workers.get(index) ?? 0, 0);
    gl.bindTexture(gl.TEXTURE_2D, this.grid);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, index % this.#columns, Math.floor(index / this.#columns), 1, 1, gl.RGBA, gl.FLOAT, texel);
  }
}

function texture(gl: WebGL2RenderingContext, width: number, height: number, levels: number): WebGLTexture {
  const made = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, made);
  gl.texStorage2D(gl.TEXTURE_2D, levels, gl.RGBA32F, width, height);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST_MIPMAP_NEAREST);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
  return made;
}
