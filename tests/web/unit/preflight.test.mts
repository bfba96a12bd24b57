/** The sentence under a preflight. */
import assert from "node:assert/strict";
import { test } from "node:test";

import type { PreflightReport, PreflightModel } from "../../../services/web/src/service/types.ts";
import { sentence } from "../../../services/web/src/submit/preflight_result.ts";

const nothing = { value: 0, low: 0, high: 0 };
const model = (without: string[]): PreflightModel => ({
  without, verdict: "not needed", mean_bias: nothing, local_bias: nothing, noise_of_a_sample: 1, cost_ratio: nothing, samples: 2500, cpu_seconds: 125,
});
const preflight = (without: string[], heavy: boolean): PreflightReport => ({
  error: 0.02,
  film: [64, 48],
  pilot: { film: [64, 48], samples: 16, renders: 4, cpu_seconds: 10, recommended_cpu_seconds: null, effective_pixels: 1000, heavy_tails: heavy },
  full: model([]),
  models: [],
  chosen: model(without),
  saving: 3.14,
  without_effect: [],
  document: { nocturne: 1, sensor: { type: "pinhole", position: [0, 0, 4], look_at: [0, 0, 0], up: [0, 1, 0], vertical_field_of_view_degrees: 40 } },
});

test("what is enough is named, with what it saves", () => {
  const said = sentence(preflight(["without medium \"fog\""], false));
  assert.equal(said.replaceAll("\u00a0", " "), "Enough for 2 %: without medium \"fog\"; 3.1 times faster. 2,500 samples, 2 min 05 s of one processor.");
});

test("where nothing simpler does, it says so", () => {
  assert.match(sentence(preflight([], false)), /^Nothing simpler is known to be faster within 2 %/);
});

test("heavy tails hide all figures", () => {
  const said = sentence(preflight(["without medium \"fog\""], true));
  assert.match(said, /nothing is chosen/);
  assert.doesNotMatch(said, /2,500/);
});
