import assert from "node:assert/strict";
import { test } from "node:test";
import type { SceneDocument } from "../../../services/web/src/service/types.ts";
import { membersOf } from "../../../services/web/src/submit/members.ts";

const scene = { nocturne: 1, sensor: { type: "pinhole", position: [0, 0, 4] }, surfaces: [{ name: "a" }, { name: "b" }] } as unknown as SceneDocument;
const nothing = { frames: "", changes: "", varied: "", bands: "" };
const at = (document: SceneDocument): { position: number[] } => (document as unknown as { sensor: { position: number[] } }).sensor;

test("without wishes there is one, and it is the scene", () => {
  assert.deepEqual(membersOf(scene, nothing), [{ name: "", document: scene }]);
});

test("frames go evenly from the first to the last", () => {
  const members = membersOf(scene, { ...nothing, frames: "8-10", changes: "sensor.position[0]=-1..1\nsensor.position[1]=2" });
  assert.deepEqual(members.map(({ name }) => name), ["08", "09", "10"]);
  assert.deepEqual(members.map(({ document }) => at(document).position), [[-1, 2, 4], [0, 2, 4], [1, 2, 4]]);
  assert.deepEqual(at(scene).position, [0, 0, 4]);
});

test("variants are every combination", () => {
  const members = membersOf(scene, { ...nothing, varied: "tracing.seed=1,2\nsurfaces[1].name=x,y" });
  assert.deepEqual(members.map(({ name }) => name), ["seed=1 name=x", "seed=1 name=y", "seed=2 name=x", "seed=2 name=y"]);
  const { tracing, surfaces } = members[3]?.document as unknown as { tracing: unknown; surfaces: unknown };
  assert.deepEqual([tracing, surfaces], [{ seed: 2 }, [{ name: "a" }, { name: "y" }]]);
});

test("values may be whole parts, and bands are a part of the sensor", () => {
  const [one, two] = membersOf(scene, { ...nothing, varied: "sensor.position=[0,0,1],[0,0,2]", bands: "380:780:10" });
  assert.deepEqual([one && at(one.document).position, two && at(two.document).position], [[0, 0, 1], [0, 0, 2]]);
  assert.deepEqual((one?.document as unknown as { sensor: { bands: unknown } }).sensor.bands, { first: 380, last: 780, width: 10 });
});

test("parts of the light are asked for in the sensor", () => {
  const [one] = membersOf(scene, { ...nothing, parts: true });
  assert.equal((one?.document as unknown as { sensor: { light_parts: unknown } }).sensor.light_parts, true);
});

test("what can't be understood is said", () => {
  for (const [wanted, said] of [
    [{ frames: "10-1" }, /Frames 10-1: expected FIRST-LAST/],
    [{ frames: "1-5000" }, /at most 1000/],
    [{ frames: "1-100", varied: "tracing.seed=1,2,3,4,5,6,7,8,9,10,11" }, /1100 renders are too many/],
    [{ bands: "380-780" }, /Bands 380-780: expected/],
    [{ changes: "sensor.position" }, /expected a place and a value/],
    [{ changes: "surfaces[2].name=x" }, /The scene has no surfaces\[2\].name/],
    [{ changes: "sensor.position.x=1" }, /The scene has no sensor.position.x/],
    [{ changes: "a b!=1" }, /is no place in a scene/],
  ] as const) assert.throws(() => membersOf(scene, { ...nothing, ...wanted }), said);
});
