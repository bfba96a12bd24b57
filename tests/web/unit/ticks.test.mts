import assert from "node:assert/strict";
import { test } from "node:test";
import { wholeTicks } from "../../../services/web/src/convergence/ticks.ts";

const digits = (value: number): number => Number(value.toExponential(12).split("e")[0]);

test("axes begin and end at 1, 2 or 5 times a power of ten, around all that is shown", () => {
  // The first of these, as a beginning of its own, kept uPlot busy until its memory ended.
  const values = [0.000977915, 1, 2, 5, 9.99, 0.1, 3e-7, 4.9e12, ...Array.from({ length: 500 }, (_, index) => 1.1 ** (index - 250))];
  for (const value of values) {
    const [low, high] = wholeTicks(value, 3 * value);
    assert.ok(low <= value * (1 + 1e-8) && high >= 3 * value * (1 - 1e-8), `${value}: ${low} to ${high}`);
    for (const end of [low, high]) assert.ok([1, 2, 5].includes(digits(end)), `${value}: ${end}`);
  }
  assert.deepEqual(wholeTicks(null, null), [0.1, 1]);
});
