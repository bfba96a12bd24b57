import assert from "node:assert/strict";
import { test } from "node:test";
import type { Reading } from "../../../services/web/src/image/tiled_image.ts";
import type { RegionReading } from "../../../services/web/src/service/types.ts";
import { rowsOf } from "../../../services/web/src/viewer/readings.ts";

const film: Reading = { region: { x: 3, y: 4, width: 2, height: 1 }, xyz: [12, 10, 8], standardError: 0.5, samples: [64, 64], invalid_samples: 0, pixels: 2 };
const measured = { quantity: "luminance", unit: "cd/m²", mean: 10 };
const told = {
  values: [
    { name: "X", mean: 12, standard_error: 0.3 },
    { name: "Y", mean: 10, standard_error: 0.7 },
    { name: "Z", mean: 8, standard_error: null },
    { name: "rod", mean: 0.25, standard_error: 0.01 },
  ],
  u_prime: 0.2124, v_prime: 0.3982, u_prime_error: 0.001, v_prime_error: 0.002,
} as RegionReading;

function rows(reading: Reading, answer: RegionReading | undefined, isAsked: boolean): Record<string, string> {
  return Object.fromEntries(rowsOf(reading, answer, isAsked, measured).map(({ name, text }) => [name, text.replaceAll("\u00a0", " ")]));
}

test("the film's numbers are there at once, a region's error when the service told it", () => {
  const before = rows(film, undefined, true);
  assert.equal(before.Luminance, "10.000 cd/m²");
  assert.equal(before["95\u00a0%"], "…");
  assert.equal(before["X Y Z"], "12.000  10.000  8.0000");
  assert.equal(before["u′ v′"], "0.2581  0.4839");
});

test("every quantity has the error that the service tells", () => {
  const after = rows(film, told, true);
  assert.equal(after["95\u00a0%"], "± 1.37 (14 %)");
  assert.equal(after["X Y Z"], "12.000 ± 0.59  10.000 ± 1.4  8.0000");
  assert.equal(after["u′ v′"], "0.2124 ± 0.0020  0.3982 ± 0.0039");
  assert.equal(after.rod, "0.25000 ± 0.020");
});

test("polarised light has degree and angle, with what is known of their errors", () => {
  const polarised = (more: object): string | undefined => rows(film, {
    ...told, linear_polarisation: { degree: 0.31234, degree_interval: [0.3, 0.325], angle_degrees: 87.25, angle_error: 0.42, ...more },
  }, true).Polarised;
  assert.equal(polarised({}), "0.312 (0.300 to 0.325), at 87.3° ± 0.42°");
  assert.equal(polarised({ degree_interval: [], angle_error: null }), "0.312, at 87.3°");
  assert.equal(rows(film, told, true).Polarised, undefined);
});

test("an image that no service knows has the error of independent pixels, and of a single one at once", () => {
  assert.equal(rows(film, undefined, false)["95\u00a0%"], "± 0.980 (9.8 %)");
  assert.equal(rows({ ...film, pixels: 1 }, undefined, true)["95\u00a0%"], "± 0.980 (9.8 %)");
});

test("what saw nothing has a bound, and no colour", () => {
  const dark = rows({ ...film, xyz: [0, 0, 0] }, undefined, false);
  assert.equal(dark.Luminance, "nothing seen");
  assert.match(dark["95\u00a0%"] ?? "", /fewer than 1 of 42.7 samples/);
  assert.equal(dark["u′ v′"], "–");
});
