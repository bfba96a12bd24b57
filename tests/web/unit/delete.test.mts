import assert from "node:assert/strict";
import { afterEach, test } from "node:test";
import { deleteRender } from "../../../services/web/src/service/client.ts";
import { Renders } from "../../../services/web/src/service/renders.ts";
import type { Render } from "../../../services/web/src/service/types.ts";

const realFetch = globalThis.fetch;

afterEach(() => {
  globalThis.fetch = realFetch;
});

function answering(status: number, body: string | null): string[] {
  const calls: string[] = [];
  globalThis.fetch = (address, options) => {
    calls.push(`${options?.method ?? "GET"} ${typeof address === "string" ? address : "?"}`);
    return Promise.resolve(new Response(body, { status, headers: { "content-type": "application/problem+json" } }));
  };
  return calls;
}

test("a render is deleted by its address", async () => {
  const calls = answering(204, null);
  await deleteRender("r-a/b");
  assert.deepEqual(calls, ["DELETE /v1/renders/r-a%2Fb"]);
});

test("why it is not deleted is told in the service's words", async () => {
  answering(409, JSON.stringify({ detail: "r-1 is RUNNING; cancel it before it is deleted" }));
  await assert.rejects(deleteRender("r-1"), { message: "r-1 is RUNNING; cancel it before it is deleted" });
});

test("what is deleted is not listed any more", () => {
  const renders = new Renders();
  for (const id of ["r-1", "r-2"]) renders.put({ id, created: 1, sequence: 1 } as Render);
  let told = 0;
  renders.subscribe(() => { told += 1; });
  renders.forget("r-1");
  assert.deepEqual(renders.newestFirst().map(({ id }) => id), ["r-2"]);
  assert.equal(told, 1);
});
