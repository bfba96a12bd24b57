import assert from "node:assert/strict";
import { test } from "node:test";
import { ended, isNewMiss } from "../../../services/web/src/service/notifier.ts";

test("a render ends once, and only if it was seen before", () => {
  assert.equal(ended("RUNNING", { state: "SUCCEEDED" }), true);
  assert.equal(ended("QUEUED", { state: "FAILED" }), true);
  assert.equal(ended("SUCCEEDED", { state: "SUCCEEDED" }), false);
  assert.equal(ended("RUNNING", { state: "PAUSED" }), false);
  assert.equal(ended(undefined, { state: "SUCCEEDED" }), false);
});

test("a miss is told once, also where it comes and goes", () => {
  const told = new Set<string>();
  const of = (target_unreachable: string): { id: string; target_unreachable: string } => ({ id: "a", target_unreachable });
  assert.equal(isNewMiss(told, "RUNNING", of("")), false);
  assert.equal(isNewMiss(told, "RUNNING", of("It will miss.")), true);
  assert.equal(isNewMiss(told, "RUNNING", of("")), false);
  assert.equal(isNewMiss(told, "RUNNING", of("It will miss.")), false);
  assert.equal(isNewMiss(new Set(), undefined, of("It was so when the page opened.")), false);
});
