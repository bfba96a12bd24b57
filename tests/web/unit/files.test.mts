/** Archives and scenes that people bring; the fixture was written by Python's zipfile. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { isOfOtherRenderer, sceneOf } from "../../../services/web/src/submit/import_scene.ts";
import { digest, documentPaths, partsWithPaths, readScene, resolved } from "../../../services/web/src/submit/scene_files.ts";
import { readZip } from "../../../services/web/src/submit/zip.ts";
import type { SceneDocument } from "../../../services/web/src/service/types.ts";
import { archive } from "./files.ts";

function bytes(base64: string): ArrayBuffer {
  return Uint8Array.from(Buffer.from(base64, "base64")).buffer;
}

test("an archive's files, packed and stored", async () => {
  const files = await readZip(new Blob([bytes(archive)]));
  assert.deepEqual([...files.keys()], ["box/scene.json", "box/meshes/a.PLY", "box/readme.txt"]);
  assert.equal(await files.get("box/meshes/a.PLY")?.text(), "ply".repeat(30));
  assert.equal(await files.get("box/readme.txt")?.text(), "stored");
});

test("what is no archive, cut short, or says a wrong length, is refused", async () => {
  await assert.rejects(readZip(new Blob(["no"])), /no ZIP/);
  const whole = new Uint8Array(bytes(archive));
  const lying = Uint8Array.from(whole);
  const entry = whole.findIndex((_, i) => whole[i] === 0x50 && whole[i + 1] === 0x4b && whole[i + 2] === 1 && whole[i + 3] === 2);
  lying[entry + 24] = 3;
  await assert.rejects(readZip(new Blob([lying])), /length/);
  const escaping = Buffer.from(whole);
  for (let at = escaping.indexOf("box/readme"); at >= 0; at = escaping.indexOf("box/readme")) escaping.write("../", at);
  await assert.rejects(readZip(new Blob([new Uint8Array(escaping)])), /leads out/);
});

test("a scene's files become digests, and a mesh says its format", async () => {
  const scene = await readScene(await readZip(new Blob([bytes(archive)])));
  assert.equal(scene.path, "box/scene.json");
  // From sha256sum of "ply" thirty times.
  const sha256 = "68186b5c8a5fe9046384905c6349b3e71760e69767d544016df45d43f69d9060";
  assert.deepEqual([...scene.files.keys()], [sha256]);
  assert.deepEqual(scene.document.surfaces, [{ shape: { type: "mesh", asset: `sha256:${sha256}`, format: "ply" } }]);
});

/** A file that is too large to be had whole, as browsers refuse files of 2 GB. */
class Large extends Blob {
  override arrayBuffer(): Promise<ArrayBuffer> {
    return Promise.reject(new Error("too large"));
  }
}

test("a file of any size has its SHA-256, piece by piece", async () => {
  // The examples of FIPS 180-2, appendix B.
  assert.equal(await digest(new Large(["abc"])), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  const pieces = Array.from({ length: 1000 }, () => "a".repeat(1000));
  assert.equal(await digest(new Large(pieces)), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
  assert.equal(await digest(new Large([])), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
});

test("what is missing is told with its place", async () => {
  const scene = await readScene(new Map([["scene.json", new Blob(['{"a": [{"asset": "x.png"}, {"asset": "../y.png"}]}'])]]));
  assert.deepEqual(scene.problems.map(({ place }) => place), ["$.a[0].asset", "$.a[1].asset"]);
  await assert.rejects(readScene(new Map([["a.txt", new Blob([])]])), /no scene document/);
  await assert.rejects(readScene(new Map([["a.json", new Blob(["[1]"])]])), /JSON object/);
});

test("the document nearest to the top, scene.json first", () => {
  assert.deepEqual(documentPaths(["deep/a/scene.json", "top/notes.json", "top/scene.json"]), ["top/scene.json"]);
  assert.deepEqual(documentPaths(["b.json", "a.json", "deep/c.json"]), ["a.json", "b.json"]);
  assert.deepEqual(documentPaths(["readme.md"]), []);
});

test("several documents are not taken by the alphabet", async () => {
  const of = (files: Record<string, string>): Map<string, Blob> => new Map(Object.entries(files).map(([path, text]) => [path, new Blob([text])]));
  const scene = '{"nocturne": 1}';
  await assert.rejects(readScene(of({ "b.json": scene, "a.json": scene })), /several scene documents: a\.json, b\.json/);
  assert.equal((await readScene(of({ "b.json": scene, "a.json": "[[400, 0.5]]", "c.json": "{}" }))).path, "b.json");
  assert.equal((await readScene(of({ "b.json": scene, "scene.json": scene }))).path, "scene.json");
  await assert.rejects(readScene(of({ "a.json": "{}", "b.json": "{}" })), /None of a\.json, b\.json/);
});

test("paths stay inside, names of responses are not files", () => {
  assert.equal(resolved("box/", "./a/b.ply"), "box/a/b.ply");
  assert.equal(resolved("box/", "/etc/passwd"), "");
  assert.equal(resolved("box/", "a/../../b"), "");
  assert.deepEqual([...partsWithPaths({ sensor: { responses: { asset: "no" } }, texture: { asset: "sha256:00" } })], []);
});

test("scenes of other renderers are told from our own", () => {
  assert.equal(isOfOtherRenderer(["room/room.gltf", "room/room.bin", "room/license.json"]), true);
  assert.equal(isOfOtherRenderer(["SPOON.GLB"]), true);
  assert.equal(isOfOtherRenderer(["box/scene.json", "box/original.xml"]), false);
  assert.equal(isOfOtherRenderer(["lamp.json", "mesh.ply"]), false);
});

test("an imported scene needs no files, and says what was left out", () => {
  const missing = [{ place: "a.xml:3", message: "no support for hair" }];
  const document = JSON.parse('{"nocturne": 1}') as SceneDocument;
  const scene = sceneOf({ document, scene: "a.xml", width: 40, height: 20, samples: null, notes: ["a point became a sphere"], missing });
  assert.deepEqual(scene.notes, ["Left out: a.xml:3: no support for hair", "a point became a sphere"]);
  assert.deepEqual([scene.film.width, scene.film.height, scene.files.size, scene.problems.length], [40, 20, 0, 0]);
});
