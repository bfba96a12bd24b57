/** Colorimetry against published numbers. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { adaptation, apply, chromaticity, colourTemperature, displayMatrix, distanceFromLocus, encodeSrgb, inverse, product, whites, xyzToSrgb } from "../../../services/web/src/image/colour.ts";

function near(actual: number | undefined, expected: number, tolerance: number): void {
  assert.ok(actual !== undefined && Math.abs(actual - expected) <= tolerance, `${actual} is not ${expected} to ${tolerance}`);
}

test("Bradford from D50 to D65 is B. Lindbloom's table", () => {
  const published = [
    [0.9555766, -0.0230393, 0.0631636],
    [-0.0282895, 1.0099416, 0.0210077],
    [0.0122982, -0.020483, 1.3299098],
  ];
  const found = adaptation(whites.D50, whites.D65);
  published.forEach((row, i) => {
    row.forEach((value, j) => {
      near(found[i]?.[j], value, 2e-6);
    });
  });
});

test("each white looks white under itself", () => {
  // The matrix of IEC 61966-2-1 has four decimals.
  for (const white of Object.values(whites)) for (const value of apply(displayMatrix(white), white)) near(value, 1, 3e-4);
});

test("the primaries of sRGB come back from their chromaticities (IEC 61966-2-1)", () => {
  const primaries = inverse(xyzToSrgb);
  const published: [number, number][] = [
    [0.64, 0.33],
    [0.3, 0.6],
    [0.15, 0.06],
  ];
  published.forEach(([x, y], column) => {
    const found = chromaticity([primaries[0][column] ?? 0, primaries[1][column] ?? 0, primaries[2][column] ?? 0]);
    near(found?.x, x, 2e-4);
    near(found?.y, y, 2e-4);
  });
});

test("a matrix times its inverse is one", () => {
  product(xyzToSrgb, inverse(xyzToSrgb)).forEach((row, i) => {
    row.forEach((value, j) => {
      near(value, i === j ? 1 : 0, 1e-12);
    });
  });
});

test("colour temperatures of CIE illuminants (CIE 15:2018)", () => {
  near(colourTemperature({ x: 0.44758, y: 0.40745 }), 2856, 10);
  near(colourTemperature({ x: 0.34567, y: 0.35851 }), 5003, 10);
  near(colourTemperature({ x: 0.31272, y: 0.32903 }), 6504, 10);
  assert.equal(colourTemperature({ x: 0.64, y: 0.33 }), undefined);
  assert.equal(colourTemperature({ x: 0.3, y: 0.6 }), undefined);
});

test("distance from the locus: none for illuminant A, 0.0032 for D65 (ANSI C78.377)", () => {
  near(distanceFromLocus({ x: 0.44758, y: 0.40745 }), 0, 1e-4);
  near(distanceFromLocus({ x: 0.31272, y: 0.32903 }), 0.0032, 1e-4);
});

test("middle grey is sRGB 118 of 255", () => {
  near(255 * encodeSrgb(0.18), 117.6, 0.1);
  near(encodeSrgb(1), 1, 1e-12);
});

test("black has no chromaticity", () => {
  assert.equal(chromaticity([0, 0, 0]), undefined);
});
