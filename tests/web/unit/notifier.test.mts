import assert from "node:assert/strict";
import { test } from "node:test";
import { ended } from "../../../services/web/src/service/notifier.ts";

test("a render ends once, and only if it was seen before", () => {
  assert.equal(ended("RUNNING", { state: "SUCCEEDED" }), true);
  assert.equal(ended("QUEUED", { state: "FAILED" }), true);
  assert.equal(ended("SUCCEEDED", { state: "SUCCEEDED" }), false);
  assert.equal(ended("RUNNING", { state: "PAUSED" }), false);
  assert.equal(ended(undefined, { state: "SUCCEEDED" }), false);
});
