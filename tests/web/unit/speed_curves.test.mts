import assert from "node:assert/strict";
import { test } from "node:test";
import type { ConvergencePoint, Render } from "../../../services/web/src/service/types.ts";
import { chosenOf, curvesOf } from "../../../services/web/src/views/speed_curves.ts";

const render = (id: string, mean_samples: number, cpu_seconds: number, relative_error: number): Render => ({ id, progress: { mean_samples, cpu_seconds, relative_error } }) as Render;
const point = (samples: number, relative_error: number): ConvergencePoint => ({ time_s: 1, samples, relative_error, top_percent_share: 0, effective_pixels: 0 });

test("renders share an axis of processor time, each with points of its own", () => {
  const curves = curvesOf([render("a", 64, 32, 0.1), render("b", 8, 2, 0.3)], [[point(4, 0.4), point(16, 0.2), point(0, 0.9)], [point(4, 0.5)]]);
  assert.deepEqual(curves.x, [1, 2, 8, 32]);
  assert.deepEqual(curves.columns, [[null, 0.4, 0.2, 0.1].map((value, index) => (index === 0 ? null : value)), [0.5, 0.3, null, null]]);
});

test("long histories are thinned, and keep their end", () => {
  const history = Array.from({ length: 1000 }, (_, index) => point(index + 1, 1 / (index + 1)));
  const { x, columns } = curvesOf([render("a", 1000, 1000, 0.001)], [history]);
  assert.ok(x.length <= 62);
  assert.deepEqual([x.at(-1), columns[0]?.at(-1)], [1000, 0.001]);
});

test("the address says which are shown, else the newest are", () => {
  const all = [render("c", 1, 1, 1), render("b", 1, 1, 1), render("a", 1, 1, 1)];
  assert.deepEqual(chosenOf(all, ["a", "gone"]).map(({ id }) => id), ["a"]);
  assert.deepEqual(chosenOf(all, ["gone"], 2).map(({ id }) => id), ["c", "b"]);
});
