import assert from "node:assert/strict";
import { test } from "node:test";
import { toCurve, together } from "../../../services/web/src/convergence/points.ts";
import { doubts, slope, uncertainty } from "../../../services/web/src/convergence/trust.ts";
import type { ConvergencePoint } from "../../../services/web/src/service/types.ts";

const pixels = 10_000;

function end<Value>(values: readonly Value[]): Value {
  return values[values.length - 1] as Value;
}

/** A history that falls as a power of the samples. */
function history(power: number, about: Partial<ConvergencePoint> = {}): ConvergencePoint[] {
  return Array.from({ length: 20 }, (_, i) => {
    const samples = 10 * 1.3 ** i;
    return { time_s: 2 * samples, samples, relative_error: samples ** power, worst_share: 0.03, effective_pixels: 8000, ...about };
  });
}

test("the slope of a power is that power", () => {
  for (const power of [-0.5, -0.2]) assert.ok(Math.abs((slope(history(power)) ?? 0) - power) < 1e-12);
  assert.equal(slope(history(-0.5).slice(-3)), undefined);
});

test("even noise that falls as 1/sqrt(N) is trusted", () => {
  assert.deepEqual(doubts(history(-0.5), pixels), []);
  assert.deepEqual(doubts([], pixels), []);
});

test("few pixels that carry the error, and a share of the worst, each raise a doubt with its reason", () => {
  assert.match(doubts(history(-0.5, { effective_pixels: 4 }), pixels).join(), /About 4.0 of 10000 pixels .* 50 %/);
  assert.match(doubts(history(-0.5, { worst_share: 0.8 }), pixels).join(), /80 % of the variance/);
  assert.match(doubts(history(-0.2), pixels).join(), /power -0.20/);
});

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
