import assert from "node:assert/strict";
import { test } from "node:test";
import { scaleOf } from "../../../services/web/src/image/look.ts";
import { clipped, TiledImage } from "../../../services/web/src/image/tiled_image.ts";
import { decodeTiles, pyramid } from "../../../services/web/src/image/tiles.ts";

/** A film of 5 x 3 in tiles of 4 x 4: the second tile is 1 x 3. Pixel values say where they are. */
function answer(): ArrayBuffer {
  const floats = (x0: number, width: number): number[] =>
    [0, 1, 2].flatMap((y) => Array.from({ length: width }, (_, x) => [x0 + x, 10 * y, 100, 0.5]).flat());
  const words = 8 + 4 + 4 * 12 + 4 + 4 * 3;
  const bytes = new ArrayBuffer(4 * words);
  const whole = new Uint32Array(bytes);
  const real = new Float32Array(bytes);
  whole.set([0x3159584e, 5, 3, 4, 2, 1, 77, 1], 0);
  whole.set([0, 16, 2, 76], 8);
  real.set(floats(0, 4), 12);
  whole.set([1, 4, 1, 77], 60);
  real.set(floats(4, 1), 64);
  return bytes;
}

function film(): TiledImage {
  const decoded = decodeTiles(answer());
  const found = new TiledImage(decoded.width, decoded.height, decoded.tileSize);
  for (const tile of decoded.tiles) found.put(tile);
  return found;
}

test("an answer says where each tile is, and where to go on", () => {
  const decoded = decodeTiles(answer());
  assert.deepEqual([decoded.width, decoded.height, decoded.tileSize, decoded.more, decoded.cursor], [5, 3, 4, true, "77.1"]);
  const places = decoded.tiles.map(({ index, x, y, width, height, samples, invalid_samples }) => [index, x, y, width, height, samples, invalid_samples]);
  assert.deepEqual(places, [[0, 0, 0, 4, 3, 16, 2], [1, 4, 0, 1, 3, 4, 1]]);
});

test("something else is refused", () => {
  assert.throws(() => decodeTiles(new ArrayBuffer(4)));
  assert.throws(() => decodeTiles(new ArrayBuffer(64)));
});

test("pixels are found in the right tile", () => {
  const found = film();
  assert.deepEqual([...(found.pixel(3, 2)?.values ?? [])], [3, 20, 100, 0.5]);
  assert.deepEqual([...(found.pixel(4, 1)?.values ?? [])], [4, 10, 100, 0.5]);
  assert.equal(found.pixel(5, 0), undefined);
});

test("a region: means, and the error of the mean of independent pixels", () => {
  const reading = film().read({ x: 2, y: 0, width: 3, height: 3 });
  assert.ok(reading);
  assert.deepEqual(reading.xyz, [3, 10, 100]);
  assert.deepEqual([reading.samples, reading.invalid_samples, reading.pixels], [[4, 16], 3, 9]);
  // Nine variances of 0.25, divided by 9 squared.
  assert.ok(Math.abs(reading.standardError - 0.5 / 3) < 1e-7);
});

test("a region is cut to the film", () => {
  assert.deepEqual(clipped({ x: -2, y: 1, width: 5, height: 9 }, { width: 5, height: 3 }), { x: 0, y: 1, width: 3, height: 2 });
  assert.deepEqual(clipped({ x: 9, y: 9, width: 2, height: 2 }, { width: 5, height: 3 }), { x: 4, y: 2, width: 1, height: 1 });
});

test("each level of a pyramid has the mean of the one before", () => {
  const pixels = Float32Array.from({ length: 4 * 8 * 4 }, (_, i) => (i % 4 === 0 ? i / 4 : 1));
  const levels = pyramid({ width: 8, height: 4, pixels }, 3);
  assert.deepEqual(levels.map(({ width, height }) => [width, height]), [[8, 4], [4, 2], [2, 1]]);
  assert.equal(levels[1]?.pixels[0], (0 + 1 + 8 + 9) / 4);
  const mean = pixels.filter((_, i) => i % 4 === 0).reduce((sum, value) => sum + value, 0) / 32;
  assert.equal(((levels[2]?.pixels[0] ?? 0) + (levels[2]?.pixels[4] ?? 0)) / 2, mean);
});

test("a film of more tiles than a call may have arguments has a scale and a reading", () => {
  const [across, down] = [600, 500];
  const large = new TiledImage(across, down, 1);
  for (let index = 0; index < across * down; index += 1) {
    large.put({ index, revision: 1, x: index % across, y: Math.floor(index / across), width: 1, height: 1, samples: 2 + (index % 5), invalid_samples: index % 3, pixels: new Float32Array([1, 2, 3, 0]) });
  }
  assert.equal(scaleOf("samples", large).high, 6);
  assert.equal(scaleOf("invalid_samples", large).high, 2);
  assert.deepEqual(large.read({ x: 0, y: 0, width: across, height: down })?.samples, [2, 6]);
});
