import assert from "node:assert/strict";
import { test } from "node:test";
import { formatCount, formatDuration, formatRelativeError, formatSamples, formatStops, formatValue, shownUnit } from "../../../services/web/src/format.ts";

const cases: [string, string][] = [
  [formatCount(0), "0"],
  [formatCount(999), "999"],
  [formatCount(999.7), "1.00 k"],
  [formatCount(1_234_567), "1.23 M"],
  [formatCount(9.87e17), "987 P"],
  [formatCount(NaN), "–"],
  [formatRelativeError(0), "–"],
  [formatRelativeError(0.0123), "1.2 %"],
  [formatRelativeError(0.00042), "0.042 %"],
  [formatRelativeError(2.5), "250 %"],
  [formatSamples(4096), "4,096"],
  [formatSamples(12.25), "12.3"],
  [formatDuration(0.84), "0.8 s"],
  [formatDuration(59.9), "59 s"],
  [formatDuration(185), "3 min 05 s"],
  [formatDuration(7621), "2 h 07 min"],
  [formatValue(3663.4, 3), "3660"],
  [formatValue(0.0123456), "0.012346"],
  [formatValue(12.3456789), "12.346"],
  [formatValue(1.5e-7, 3), "1.50e-7"],
  [formatValue(12_345_678), "1.2346e7"],
  [formatValue(NaN), "–"],
  [formatStops(1.5), "+1.5 EV"],
  [shownUnit("cd/m2"), "cd/m²"],
  [shownUnit("umol m-2 s-1"), "µmol m⁻² s⁻¹"],
  [formatStops(-2), "−2.0 EV"],
];

for (const [shown, expected] of cases) {
  test(`shows ${expected}`, () => {
    assert.equal(shown.replaceAll("\u00a0", " "), expected);
  });
}
