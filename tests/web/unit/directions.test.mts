/** A map of directions about a surface, against angles that are known. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { outlineOf } from "../../../services/web/src/viewer/directions.ts";

const normal = [0, 0, 1];
/** Looked at aslant: along y and down. */
const direction = [0, Math.SQRT1_2, -Math.SQRT1_2];
const narrow = (axis: number[]): [number, number][] => outlineOf({ axis, half_angle_degrees: 1e-3 }, normal, direction);

function near([x = 0, y = 0]: readonly number[], expected: readonly [number, number]): void {
  assert.ok(Math.hypot(x - expected[0], y - expected[1]) < 1e-4, `${x}, ${y} is not ${expected.join(", ")}`);
}

test("the normal is in the middle, what lies behind at the top, what lies to the right there", () => {
  for (const point of narrow([0, 0, 1])) near(point, [0, 0]);
  for (const point of narrow([0, 1, 0])) near(point, [0, -1]);
  for (const point of narrow([1, 0, 0])) near(point, [1, 0]);
});

test("60 degrees from the normal are half of the hemisphere, and half of the disc", () => {
  for (const point of narrow([Math.sin(Math.PI / 3), 0, 0.5])) near(point, [Math.SQRT1_2, 0]);
});

test("a cone about the normal has its part of the hemisphere's solid angle", () => {
  for (const [x, y] of outlineOf({ axis: normal, half_angle_degrees: 40 }, normal, direction)) {
    assert.ok(Math.abs(x * x + y * y - (1 - Math.cos((40 * Math.PI) / 180))) < 1e-9);
  }
});

test("what comes from below is on the edge", () => {
  for (const point of narrow([0.6, 0, -0.8])) near(point, [1, 0]);
});

test("a surface that is looked at squarely has a map, too", () => {
  for (const [x, y] of outlineOf({ axis: [0, 0, 1], half_angle_degrees: 10 }, normal, [0, 0, -1])) assert.ok(Number.isFinite(x + y));
});
