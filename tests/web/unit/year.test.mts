import assert from "node:assert/strict";
import { test } from "node:test";
import { isOfRoom, leadOf, readingsOf } from "../../../services/web/src/measure/result.ts";
import { figureNames, figureText, histogramOf, monthlyMeans, monthStarts, plansOf, type Point, probabilityText, shareText, stepOf, verdictText } from "../../../services/web/src/measure/year.ts";

const plain = (text: string): string => text.replaceAll("\u00a0", " ");
const figure = (value: number) => ({ value, low: value - 0.01, high: value + 0.01 });
const at = (instrument: string, x: number, z: number, value: number): Point => ({ instrument, place: [x, 0.8, z], DA: figure(value) });

test("verdicts come with their interval and probability, which is never 0 or 1", () => {
  assert.equal(plain(shareText("sDA", { value: 0.552, low: 0.521, high: 0.562 })), "sDA 55.2 % (52.1 to 56.2)");
  assert.equal(plain(verdictText({ says: "sDA >= 55%", probability: 0.41 })), "P(sDA ≥ 55 %) = 0.41");
  assert.equal(probabilityText(1), "> 0.99");
  assert.equal(probabilityText(0), "< 0.01");
});

test("figures are told in their unit, others in per cent", () => {
  assert.equal(plain(figureText("DA", { value: 0.5078, low: 0.5039, high: 0.5117 })), "50.78 ± 0.39 %");
  assert.equal(plain(figureText("hours above", { value: 1853, low: 1839, high: 1867 })), "1853 ± 14 h");
});

test("a grid's rows end where its next point is not one step further; eyes are no plan", () => {
  const points = [at("desk", 1, 3, 0.1), at("desk", 2, 3, 0.2), at("desk", 3, 3, 0.3), at("desk", 1, 1, 0.4), at("desk", 2, 1, 0.5), at("desk", 3, 1, 0.6), at("eye", 2, 2, 0.7)];
  const plans = plansOf({ points, eyes: points.slice(6) });
  assert.deepEqual(plans.map(({ instrument, columns, points: own }) => [instrument, columns, own.length]), [["desk", 3, 6]]);
  assert.deepEqual(plansOf({ points: points.slice(0, 1), eyes: [] }).map(({ columns }) => columns), [1]);
  assert.deepEqual(figureNames({ points }), ["DA"]);
});

test("every value is in a bin of the histogram, equal ones as well", () => {
  assert.deepEqual(histogramOf([0, 1, 2, 4], 4).counts, [1, 1, 1, 1]);
  assert.deepEqual(histogramOf([3, 3], 2).counts, [2, 0]);
});

test("months begin where they do, and their means are of the hours that count", () => {
  assert.deepEqual(monthStarts(365).slice(0, 4), [0, 31, 59, 90]);
  assert.equal(monthStarts(366)[2], 60);
  const hourly = Array.from({ length: 8760 }, (_, hour) => (hour % 24 === 12 ? 1000 : hour % 24 === 3 ? 500 : 0));
  for (const mean of monthlyMeans(hourly, 8, 18)) assert.ok(Math.abs(mean - 100) < 1e-9);
});

test("steps of illuminance begin at their number", () => {
  assert.deepEqual([0, 49, 50, 299, 300, 1e5].map(stepOf), [0, 0, 1, 3, 4, 9]);
});

test("a result is of meters that measure illuminance, and leads with its verdict", () => {
  assert.ok(isOfRoom({ sensor: "meters", quantity: "illuminance" }));
  assert.ok(!isOfRoom({ sensor: "daylight", quantity: "illuminance" }));
  assert.ok(!isOfRoom({ sensor: "meters", quantity: "irradiance" }));
  assert.deepEqual(leadOf({ verdict: "fails", says: "it does not hold: U0." }), { word: "Does not hold", sentence: "it does not hold: U0." });
  assert.equal(leadOf({ verdict: "", says: "" }).word, "");
  const table = { head: ["", "Em"], rows: [["desk", "500"]] };
  const sections = [{ title: "Illuminance: desk", tables: [table] }, { title: "Luminaires", tables: [table] }, { title: "Points", tables: [] }];
  assert.deepEqual(readingsOf({ sections }), [{ title: "Illuminance: desk", ...table }]);
});
