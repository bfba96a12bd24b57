import assert from "node:assert/strict";
import { test } from "node:test";
import { compareRoute, groupRoute, parseRoute, renderRoute } from "../../../services/web/src/router.ts";

test("a render's address is read back", () => {
  assert.deepEqual(parseRoute(renderRoute("a/b c")), { page: "render", id: "a/b c" });
});

test("a comparison's address is read back, with and without a second", () => {
  assert.deepEqual(parseRoute(compareRoute("a/b", "c d")), { page: "compare", first: "a/b", second: "c d" });
  assert.deepEqual(parseRoute(groupRoute("film 1/2")), { page: "group", name: "film 1/2" });
  assert.deepEqual(parseRoute(compareRoute("a")), { page: "compare", first: "a", second: undefined });
});

test("the start is the list, all else is unknown", () => {
  for (const hash of ["", "#", "#/"]) assert.deepEqual(parseRoute(hash), { page: "list" });
  for (const hash of ["#/renders/", "#/renders/a/b", "#/renders/%", "#other"]) assert.deepEqual(parseRoute(hash), { page: "unknown" });
});
