import assert from "node:assert/strict";
import { test } from "node:test";
import type { Render } from "../../../services/web/src/service/types.ts";
import { whyNothingIsShown } from "../../../services/web/src/viewer/render_image.ts";

const text = (state: Render["state"], mean_samples: number): string => whyNothingIsShown({ state, progress: { mean_samples } } as Render);

test("a render that has samples is only not loaded yet", () => {
  assert.equal(text("SUCCEEDED", 100), "Loading the image.");
  assert.equal(text("RUNNING", 100), "Loading the image.");
});

test("one that ended without samples never shows an image", () => {
  assert.equal(text("CANCELLED", 0), "No image: it ended before its first samples.");
  assert.equal(text("RUNNING", 0), "No samples yet.");
});
