/** Fetching and decoding previews: one request at a time, the newest wish wins. */
import { previewAddress } from "../service/client.ts";

export class PreviewSource {
  readonly #id: string;
  readonly #onPixels: (pixels: ImageData) => void;
  #etag = "";
  #busy = false;
  #wanted = false;
  #closed = false;

  constructor(id: string, onPixels: (pixels: ImageData) => void) {
    this.#id = id;
    this.#onPixels = onPixels;
  }

  /** Asks for the newest preview; calls back only if it changed. */
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
        await this.#fetchOnce();
      } catch {
        // Out of reach or half written: the next event asks again.
      }
    }
    this.#busy = false;
  }

  async #fetchOnce(): Promise<void> {
    const headers = this.#etag ? { "If-None-Match": this.#etag } : {};
    const response = await fetch(previewAddress(this.#id), { headers, cache: "no-store" });
    if (!response.ok) return; // 304: nothing new; 404: nothing yet.
    const pixels = await decodePixels(await response.blob());
    this.#etag = response.headers.get("etag") ?? "";
    if (!this.#closed) this.#onPixels(pixels);
  }
}

async function decodePixels(blob: Blob): Promise<ImageData> {
  const bitmap = await createImageBitmap(blob, { colorSpaceConversion: "none" });
  const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
  const context = canvas.getContext("2d", { willReadFrequently: true });
  if (!context) throw new Error("this browser has no 2D canvas");
  context.drawImage(bitmap, 0, 0);
  bitmap.close();
  return context.getImageData(0, 0, canvas.width, canvas.height);
}
