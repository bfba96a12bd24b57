import assert from "node:assert/strict";
import { test } from "node:test";
import { ticks } from "../../../services/web/src/image/colour_maps.ts";
import { glareMarks, glareText, hasGlare } from "../../../services/web/src/measure/glare.ts";
import { isWhole, parsePoints, pointsText } from "../../../services/web/src/measure/outlines.ts";
import type { Glare, Measurements } from "../../../services/web/src/service/types.ts";

test("points are read as people type them, and written as they are read", () => {
  assert.deepEqual(parsePoints("polygon", " 0,0  64 0; 64, 64.5 "), [[0, 0], [64, 0], [64, 64.5]]);
  assert.equal(pointsText([[0, 0], [64, 64.5]]), "0,0 64,64.5");
  assert.deepEqual(parsePoints("line", pointsText([[1, 2], [3, 4]])), [[1, 2], [3, 4]]);
});

test("what is no outline is refused", () => {
  for (const text of ["", "1", "1,2", "1,2,3", "1,2 3,x", "1,2 3,4 5,6"]) assert.throws(() => parsePoints("rectangle", text), /two points/, text);
  assert.throws(() => parsePoints("polygon", "0,0 1,1"), /three corners/);
});

test("the whole image is known from a part of it", () => {
  const of = (points: number[][], name = ""): Measurements => ({ measurements: [{ outline: { kind: "rectangle", name, points } }] }) as unknown as Measurements;
  assert.ok(isWhole(of([[0, 0], [40, 30]]), { width: 40, height: 30 }));
  assert.ok(!isWhole(of([[0, 0], [40, 30]], "all"), { width: 40, height: 30 }));
  assert.ok(!isWhole(of([[0, 0], [40, 29]]), { width: 40, height: 30 }));
});

test("a narrow logarithmic scale has numbers between powers of ten", () => {
  assert.deepEqual(ticks({ low: 5, high: 60, logarithmic: true }).map(({ value }) => value), [5, 10, 20, 50]);
  assert.deepEqual(ticks({ low: 1, high: 1e4, logarithmic: true }).map(({ value }) => value), [1, 10, 100, 1000, 10000]);
  assert.deepEqual(ticks({ low: 6, high: 9, logarithmic: true }).map(({ value }) => value), [6, 9]);
});

test("a rating says what it is not for", () => {
  const glare: Glare = {
    ugr: 19.26, ugr_error: 0.04, dgp: 0.31, dgp_error: null, vertical_illuminance: 1234.6, vertical_illuminance_error: 2,
    background_luminance: 60, sources: [], dgp_sources: [], notes: ["DGP is for others"],
  };
  assert.equal(glareText(glare), "Glare for who looks at the middle: UGR 19.3 ±\u00a00.078 (95\u00a0%), DGP 0.310, 1235 lx at the eye. (DGP is for others)");
  assert.match(glareText({ ...glare, ugr: null, dgp: null, notes: [] }), /UGR is not known, 1235 lx at the eye\.$/);
});

test("glare is asked for of panoramas alone, of which the service rates it", () => {
  const film = { width: 384, height: 192 };
  assert.ok(hasGlare({ ...film, sensor: "panorama" }));
  for (const sensor of ["irradiance_meter", "intensity_meter", "pinhole", ""]) assert.ok(!hasGlare({ ...film, sensor }), sensor);
  assert.ok(!hasGlare({ width: 4096, height: 2048, sensor: "panorama" }));
});

test("sources of glare are marked where they are on a panorama", () => {
  const source = { luminance: 1e4, solid_angle: Math.PI * (Math.PI / 18) ** 2, position_index: 1, azimuth_degrees: 90, elevation_degrees: 0 };
  const [mark] = glareMarks({ sources: [source] }, { width: 360, height: 180 });
  assert.ok(mark);
  const xs = mark.points.map(([x = 0]) => x);
  const ys = mark.points.map(([, y = 0]) => y);
  // A circle of ten degrees around the point a quarter to the right.
  assert.deepEqual([Math.min(...xs), Math.max(...xs)].map(Math.round), [260, 280]);
  assert.deepEqual([Math.min(...ys), Math.max(...ys)].map(Math.round), [80, 100]);
  assert.equal(mark.name, "1");
});
