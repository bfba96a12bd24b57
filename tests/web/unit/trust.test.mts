import assert from "node:assert/strict";
import { test } from "node:test";
import { toCurve, together } from "../../../services/web/src/convergence/points.ts";
import { uncertainty } from "../../../services/web/src/convergence/trust.ts";
import type { ConvergencePoint } from "../../../services/web/src/service/types.ts";

function end<Value>(values: readonly Value[]): Value {
  return values[values.length - 1] as Value;
}

/** A history that falls as a power of the samples. */
function history(power: number, about: Partial<ConvergencePoint> = {}): ConvergencePoint[] {
  return Array.from({ length: 20 }, (_, i) => {
    const samples = 10 * 1.3 ** i;
    return { time_s: 2 * samples, samples, relative_error: samples ** power, top_percent_share: 0.03, effective_pixels: 8000, ...about };
  });
}

test("the band: two standard deviations of a root of a mean of n", () => {
  assert.equal(uncertainty(400), 0.05);
  assert.equal(uncertainty(0), 0);
  assert.equal(uncertainty(0.5), 1);
});

test("the forecast reaches the target along 1/sqrt(N)", () => {
  const points = history(-0.5);
  const last = end(points);
  const target = last.relative_error / 3;
  const curve = toCurve(points, "samples", { relativeError: target, samples: 1e9 });
  assert.ok(Math.abs((end(curve.prediction) ?? 0) / target - 1) < 1e-12);
  assert.ok(Math.abs(end(curve.x) / (9 * last.samples) - 1) < 1e-12);
  assert.ok((end(curve.low) ?? 0) < target && (end(curve.high) ?? 0) > target);
  for (const column of [curve.error, curve.guide, curve.target, curve.prediction, curve.low, curve.high]) assert.equal(column.length, curve.x.length);
});

test("the last sample may come before the target; what is reached is not forecast", () => {
  const points = history(-0.5);
  const last = end(points);
  const curve = toCurve(points, "samples", { relativeError: 1e-9, samples: 2 * last.samples });
  assert.ok(Math.abs(end(curve.x) / (2 * last.samples) - 1) < 1e-12);
  const done = toCurve(points, "samples", { relativeError: 0, samples: last.samples });
  assert.equal(done.x.length, points.length);
});

test("two histories on one axis", () => {
  const both = together([{ x: 1, error: 0.5 }, { x: 3, error: 0.2 }], [{ x: 2, error: 0.4 }]);
  assert.deepEqual(both, { x: [1, 2, 3], first: [0.5, null, 0.2], second: [null, 0.4, null] });
});
