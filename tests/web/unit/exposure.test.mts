import assert from "node:assert/strict";
import { test } from "node:test";
import { applyExposure, exposureTable } from "../../../services/web/src/image/exposure.ts";

test("no exposure leaves every byte as it is", () => {
  assert.deepEqual([...exposureTable(0)], Array.from({ length: 256 }, (_, byte) => byte));
});

test("one stop doubles linear light: sRGB 188 is half of full light", () => {
  const brighter = exposureTable(1);
  const darker = exposureTable(-1);
  assert.equal(brighter[188], 255);
  assert.equal(darker[255], 188);
});

test("tables are monotone and clip at white", () => {
  for (const stops of [-6, -0.1, 0.1, 6]) {
    const table = exposureTable(stops);
    assert.deepEqual([...table], [...table].toSorted((a, b) => a - b));
  }
  assert.equal(exposureTable(6)[255], 255);
});

test("alpha is copied, colours go through the table", () => {
  const source = Uint8ClampedArray.of(188, 0, 255, 77);
  const target = new Uint8ClampedArray(4);
  applyExposure(source, target, exposureTable(1));
  assert.deepEqual([...target], [255, 0, 255, 77]);
});
