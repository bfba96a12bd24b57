import assert from "node:assert/strict";
import { test } from "node:test";
import { sentence } from "../../../services/web/src/viewer/unmet_parts.ts";

const film = { width: 100, height: 100 };

test("how much of an image may lack light is told in whole percents", () => {
  const parts = [{ x: 0, y: 0, width: 50, height: 20, part: 0.3 }, { x: 0, y: 20, width: 10, height: 10, part: 2 }];
  assert.match(sentence(parts, film), /^Hatched, 11 % of the image: light /);
  assert.match(sentence([{ x: 0, y: 0, width: 5, height: 5, part: 0.3 }], film), /^Hatched, less than 1 % of the image: /);
});
