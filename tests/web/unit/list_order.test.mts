import assert from "node:assert/strict";
import { test } from "node:test";
import type { Render } from "../../../services/web/src/service/types.ts";
import { requestOf } from "../../../services/web/src/submit/form.ts";
import { listed, queryOf, wishOf } from "../../../services/web/src/views/list_order.ts";

function render(id: string, name: string, state: Render["state"], error: number, predicted_end: number, cpu_seconds: number): Render {
  return { id, name, owner: "", tags: [], state, ended: 5, progress: { relative_error: error, predicted_end, cpu_seconds } } as unknown as Render;
}

const all = [render("r-3", "glass", "RUNNING", 0.1, 300, 5), render("r-2", "box", "SUCCEEDED", 0.5, 0, 50), render("r-1", "sky", "RUNNING", 0.2, 200, 1)];
const ids = (wish: Partial<Parameters<typeof listed>[1]>): string => listed(all, { text: "", kind: "all", order: "newest", group: "", ...wish }).map(({ id }) => id).join();

test("an address says what the list shows", () => {
  const wish = { text: "a & b", kind: "ended", order: "cost", group: "film" } as const;
  assert.deepEqual(wishOf(queryOf(wish), "film"), wish);
  assert.equal(queryOf(wishOf("", "")), "");
  assert.deepEqual(wishOf("show=nothing&order=toString", ""), { text: "", kind: "all", order: "newest", group: "" });
});

test("filters by words and by state", () => {
  assert.equal(ids({}), "r-3,r-2,r-1");
  assert.equal(ids({ text: "RUNNING s" }), "r-3,r-1");
  assert.equal(ids({ text: "box" }), "r-2");
  assert.equal(ids({ kind: "ended" }), "r-2");
});

test("orders", () => {
  assert.equal(ids({ order: "name" }), "r-2,r-3,r-1");
  assert.equal(ids({ order: "error" }), "r-2,r-1,r-3");
  assert.equal(ids({ order: "finish" }), "r-1,r-3,r-2");
  assert.equal(ids({ order: "cost" }), "r-2,r-3,r-1");
});

test("a form asks for what stands in it, and for nothing that is left empty", () => {
  const fields: Record<string, string> = { name: "box", width: "64", height: "48", samples: "16", priority: "200", error: "0.5", minutes: "", until: " " };
  const zone = Intl.DateTimeFormat().resolvedOptions().timeZone;
  assert.equal(requestOf((name) => (name === "until" ? " 07:00 " : "1"), []).stop.until, `07:00 ${zone}`);
  assert.equal(requestOf((name) => (name === "until" ? "07:00 Asia/Tokyo" : "1"), []).stop.until, "07:00 Asia/Tokyo");
  assert.deepEqual(requestOf((name) => fields[name] ?? "", ["depth"]), { name: "box", width: 64, height: 48, samples: 16, priority: 200, layers: ["depth"], stop: { relative_error: 0.005 } });
});
