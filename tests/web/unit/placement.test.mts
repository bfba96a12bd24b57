import assert from "node:assert/strict";
import { test } from "node:test";
import { decades, mapBytes, maps, ticks } from "../../../services/web/src/image/colour_maps.ts";
import { filmPoint, fitted, kept, levelFor, panned, zoomed } from "../../../services/web/src/image/placement.ts";

const film = { width: 400, height: 200 };
const canvas = { width: 800, height: 600 };

test("a film fits: enlarged by halves, made smaller as needed", () => {
  assert.deepEqual(fitted(film, canvas), { scale: 2, x: 200, y: 100 });
  assert.equal(fitted({ width: 3840, height: 2160 }, canvas).scale, 800 / 3840);
  assert.equal(fitted({ width: 300, height: 200 }, canvas).scale, 2.5);
});

test("zooming keeps the point under the cursor", () => {
  const at = { x: 650, y: 320 };
  const before = fitted(film, canvas);
  const after = zoomed(before, 1.5, at, film, canvas);
  assert.equal(after.scale, 3);
  assert.deepEqual(filmPoint(after, at, canvas), filmPoint(before, at, canvas));
});

test("zoom and pan have ends", () => {
  const start = fitted(film, canvas);
  assert.equal(zoomed(start, 1e9, { x: 0, y: 0 }, film, canvas).scale, 128);
  assert.equal(zoomed(start, 1e-9, { x: 0, y: 0 }, film, canvas).scale, 0.5);
  assert.deepEqual(panned(start, { x: 1e6, y: -1e6 }, film, canvas), { scale: 2, x: 0, y: 200 });
  assert.deepEqual(panned(start, { x: 10, y: 0 }, film, canvas), { scale: 2, x: 195, y: 100 });
  assert.deepEqual(kept({ scale: 1e9, x: -1, y: 1e9 }, film, canvas), { scale: 128, x: 0, y: 200 });
});

test("a level for each halving", () => {
  assert.deepEqual([4, 1, 0.5, 0.25, 0.24, 0.001].map((scale) => levelFor(scale, 6)), [0, 0, 1, 2, 2, 5]);
});

test("scales: whole decades around the values, ticks at powers of ten", () => {
  const scale = decades(Array.from({ length: 1000 }, (_, i) => 0.5 + i));
  assert.deepEqual(scale, { low: 1, high: 1000, logarithmic: true });
  assert.deepEqual(ticks(scale).map(({ value }) => value), [1, 10, 100, 1000]);
  assert.deepEqual(ticks({ low: -4, high: 4, logarithmic: false }).map(({ value }) => value), [-4, -2, 0, 2, 4]);
  assert.deepEqual(decades([]), { low: 0.1, high: 1, logarithmic: true });
});

test("maps begin and end with their own colours", () => {
  const bytes = mapBytes(maps.viridis);
  assert.deepEqual([...bytes.subarray(0, 4)], [0x44, 0x01, 0x54, 255]);
  assert.deepEqual([...bytes.subarray(-4)], [0xfd, 0xe7, 0x25, 255]);
});
