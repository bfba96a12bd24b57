import assert from "node:assert/strict";
import { test } from "node:test";
import { legendTitle, measured } from "../../../services/web/src/image/look.ts";
import type { Render } from "../../../services/web/src/service/types.ts";

const of = (quantity: string, unit: string): Render => ({ quantity, unit, progress: { mean: 2 } }) as Render;

test("the numbers of an image have the quantity and the unit of its sensor", () => {
  assert.equal(legendTitle("luminance", measured(of("luminance", "cd/m2"))), "Luminance, cd/m²");
  assert.equal(legendTitle("luminance", measured(of("illuminance", "lx"))), "Illuminance, lx");
  assert.equal(legendTitle("error", measured(of("luminous intensity", "cd"))), "Standard error of luminous intensity, cd");
  assert.equal(legendTitle("luminance", measured(of("", ""))), "Y");
});
