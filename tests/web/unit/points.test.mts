import assert from "node:assert/strict";
import { test } from "node:test";
import { appended, toCurve } from "../../../services/web/src/convergence/points.ts";
import type { ConvergencePoint } from "../../../services/web/src/service/types.ts";

const point = (time_s: number, relative_error: number): ConvergencePoint => ({
  time_s,
  samples: 10 * time_s,
  relative_error,
  top_percent_share: 0,
  effective_pixels: 0,
});

test("the guide is the error itself where that falls as 1/sqrt(N)", () => {
  const points = [1, 4, 9, 16].map((time) => point(time, 0.5 / Math.sqrt(time)));
  for (const abscissa of ["time", "samples"] as const) {
    const { error, guide } = toCurve(points, abscissa);
    guide.forEach((value, index) => {
      assert.ok(Math.abs((value ?? NaN) - (error[index] ?? NaN)) < 1e-12);
    });
  }
});

test("what a logarithm cannot take, and steps backwards, are left out", () => {
  const curve = toCurve([point(0, 0.5), point(1, 0), point(2, 0.4), point(2, 0.3), point(1.5, 0.2), point(3, 0.1)], "time");
  assert.deepEqual(curve.x, [2, 3]);
  assert.deepEqual(curve.error, [0.4, 0.1]);
});

test("a long history is thinned evenly over the logarithm and keeps its ends", () => {
  const curve = toCurve(
    Array.from({ length: 30_000 }, (_, index) => point(index + 1, 1 / Math.sqrt(index + 1))),
    "time",
  );
  assert.ok(curve.x.length <= 302, `${curve.x.length} points`);
  assert.ok(curve.x.length > 150, `${curve.x.length} points`);
  assert.deepEqual([curve.x[0], curve.x.at(-1)], [1, 30_000]);
});

test("live points are appended once each", () => {
  const first = appended([], point(1, 0.5));
  assert.equal(first.length, 1);
  assert.equal(appended(first, point(1, 0.5)), first);
  assert.equal(appended(first, point(2, 0)), first);
  assert.equal(appended(first, point(2, 0.4)).length, 2);
});
