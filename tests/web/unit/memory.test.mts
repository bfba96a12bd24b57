import assert from "node:assert/strict";
import { test } from "node:test";
import { whites } from "../../../services/web/src/image/colour.ts";
import type { Look } from "../../../services/web/src/image/look.ts";
import { parseRoute } from "../../../services/web/src/router.ts";
import { fromQuery, type Remembered, toQuery } from "../../../services/web/src/viewer/memory.ts";

const plain: Look & Remembered = {
  show: "colour", exposure: 2, white: whites.D65, tone: "reinhard", warnClipped: false, warnGamut: false, workers: false, side: "first", wipe: 0.5,
  scale: { low: 0, high: 1, logarithmic: false }, ranges: {}, chosen: undefined, measured: { quantity: "Y", unit: "", mean: 0 }, isAuto: true, placement: undefined,
};

test("what was not changed is not in the address", () => {
  assert.equal(toQuery(plain), "");
  assert.deepEqual(fromQuery(""), {});
});

test("an address says how the image was looked at", () => {
  const look: Remembered = { ...plain, isAuto: false, placement: { x: 12.34, y: 5, scale: 8 }, show: "luminance", tone: "filmic", exposure: 0.00012345, ranges: { luminance: { low: 5, high: 60, logarithmic: true } }, chosen: { x: 1, y: 2, width: 3, height: 4 } };
  const text = toQuery(look);
  assert.equal(text, "view=luminance&tone=filmic&exposure=0.0001234&range=5,60,log&region=1,2,3,4&at=12.3,5.0,8.00");
  const { show, tone, ranges, chosen } = look;
  assert.deepEqual(fromQuery(text), { show, tone, ranges, chosen, exposure: 0.0001234, placement: { x: 12.3, y: 5, scale: 8 } });
});

test("an address says what looks white: by name, or as somebody picked it in the image", () => {
  assert.equal(toQuery({ ...plain, white: whites.D50 }), "white=D50");
  assert.deepEqual(fromQuery("white=D50"), { white: whites.D50 });
  assert.equal(toQuery({ ...plain, white: [1.0985, 1, 0.35592] }), "white=1.0985,0.3559");
  assert.deepEqual(fromQuery("white=1.0985,0.3559"), { white: [1.0985, 1, 0.3559] });
  for (const wrong of ["D66", "toString", "0,1", "1", "1,x", "1e999,1"]) assert.deepEqual(fromQuery(`white=${wrong}`), {}, wrong);
});

test("an address says where the wipe is", () => {
  assert.equal(toQuery({ ...plain, side: "wipe", wipe: 0.3 }), "wipe=0.300");
  assert.deepEqual(fromQuery("wipe=0.300"), { side: "wipe", wipe: 0.3 });
  assert.equal(toQuery({ ...plain, side: "second" }), "side=second");
  assert.deepEqual(fromQuery("side=second"), { side: "second" });
  assert.deepEqual(fromQuery("wipe=2&side=third"), {});
});

test("what an address says wrongly is left out", () => {
  assert.deepEqual(fromQuery("view=nothing&tone=&exposure=-1&range=9,1,log&region=1,2,3&at=1,2,0"), {});
  assert.deepEqual(fromQuery("view=luminance&range=0,9,log").ranges, { luminance: { low: 0, high: 9, logarithmic: false } });
});

test("the route is what stands before it", () => {
  assert.deepEqual(parseRoute("#/renders/r-1?view=error"), { page: "render", id: "r-1" });
});
