import assert from "node:assert/strict";
import { test } from "node:test";
import { parseRoute, renderRoute } from "../../../services/web/src/router.ts";

test("a render's address is read back", () => {
  assert.deepEqual(parseRoute(renderRoute("a/b c")), { page: "render", id: "a/b c" });
});

test("the start is the list, all else is unknown", () => {
  for (const hash of ["", "#", "#/"]) assert.deepEqual(parseRoute(hash), { page: "list" });
  for (const hash of ["#/renders/", "#/renders/a/b", "#/renders/%", "#other"]) assert.deepEqual(parseRoute(hash), { page: "unknown" });
});
