/** Keeps an image up to date: only tiles that changed are fetched, one request at a time, the newest wish wins. */
import { TiledImage } from "./tiled_image.ts";
import { decodeTiles, type Tile, type TileAnswer } from "./tiles.ts";

export interface FilmListener {
  /** An image of this size begins. */
  onImage: (image: TiledImage) => void;
  onTiles: (tiles: Tile[]) => void;
}

export class ImageSource {
  readonly #address: string;
  readonly #listener: FilmListener;
  #image: TiledImage | undefined;
  #cursor = "";
  #busy = false;
  #wanted = false;
  #closed = false;

  /** `address`: of the render's tiles. */
  constructor(address: string, listener: FilmListener) {
    this.#address = address;
    this.#listener = listener;
  }

  /** Fetches what changed since the last time, if anything did. */
  request(): void {
    this.#wanted = true;
    if (!this.#busy) void this.#fetchWanted();
  }

  close(): void {
    this.#closed = true;
  }

  async #fetchWanted(): Promise<void> {
    this.#busy = true;
    while (this.#wanted && !this.#closed) {
      this.#wanted = false;
      try {
        while (await this.#fetchOnce());
      } catch {
        // Out of reach: the next event, or the next connection, asks again.
      }
    }
    this.#busy = false;
  }

  /** Whether there is more to be had at once. */
  async #fetchOnce(): Promise<boolean> {
    const headers = this.#cursor ? { "If-None-Match": `"${this.#cursor}"` } : {};
    const response = await fetch(`${this.#address}?since=${this.#cursor}`, { headers });
    if (response.status !== 200) return false;
    const answer = decodeTiles(await response.arrayBuffer());
    if (this.#closed) return false;
    this.#take(answer);
    return answer.more;
  }

  #take(answer: TileAnswer): void {
    this.#cursor = answer.cursor;
    if (!this.#image) {
      this.#image = new TiledImage(answer.width, answer.height, answer.tileSize);
      this.#listener.onImage(this.#image);
    }
    for (const tile of answer.tiles) this.#image.put(tile);
    if (answer.tiles.length > 0) this.#listener.onTiles(answer.tiles);
  }
}
