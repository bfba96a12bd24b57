import assert from "node:assert/strict";
import { test } from "node:test";
import { membersOf } from "../../../services/web/src/submit/members.ts";

const nothing = { frames: "", changes: "", varied: "", bands: "" };

test("without wishes there is one, and it is the scene", () => {
  assert.deepEqual(membersOf(nothing), { changes: {}, varied: [], frames: null });
});

test("changes, variants and frames are sent as the service takes them", () => {
  const { changes, varied, frames } = membersOf({ ...nothing, frames: "8-10", changes: "sensor.position[0]=-1..1\nsensor.position[1]=2", varied: "tracing.seed=1,2\nsurfaces[1].name=x, y" });
  assert.deepEqual(changes, { "sensor.position[0]": "-1..1", "sensor.position[1]": 2 });
  assert.deepEqual(varied, [{ place: "tracing.seed", values: [1, 2] }, { place: "surfaces[1].name", values: ["x", "y"] }]);
  assert.deepEqual(frames, { first: 8, last: 10 });
});

test("values may be whole parts, and bands and parts of the light are the sensor's", () => {
  const { changes, varied } = membersOf({ ...nothing, varied: "sensor.position=[0,0,1],[0,0,2]", bands: "380:780:10", parts: true });
  assert.deepEqual(varied, [{ place: "sensor.position", values: [[0, 0, 1], [0, 0, 2]] }]);
  assert.deepEqual(changes, { "sensor.bands": { first: 380, last: 780, width: 10 }, "sensor.light_parts": true });
});

test("what can't be understood is said", () => {
  for (const [wanted, said] of [
    [{ frames: "10" }, /Frames 10: expected FIRST-LAST/],
    [{ bands: "380-780" }, /Bands 380-780: expected/],
    [{ changes: "sensor.position" }, /expected a place and a value/],
    [{ varied: "=1,2" }, /expected a place and a value/],
  ] as const) assert.throws(() => membersOf({ ...nothing, ...wanted }), said);
});
