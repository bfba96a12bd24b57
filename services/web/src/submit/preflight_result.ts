/** What a scene needs: the service's report as a table, and the scene that is enough. */
import { element, scroller, table, tableRow } from "../dom.ts";
import { formatDuration } from "../format.ts";
import type { Interval, PreflightReport, PreflightModel } from "../service/types.ts";

/** The table, and a button that takes the simpler scene where there is one. */
export function preflightResult(preflight: PreflightReport, onTake: () => void): HTMLElement[] {
  const heads = ["Without", "Mean luminance", "Relative RMSE", "Time per sample", "Verdict", "Time to the target"];
  const rows = preflight.models.map((model) => tableRow(model.without.join(", "), cellsOf(model)));
  const report = scroller("preflight", "Table of what was tried");
  report.append(table(heads, rows));
  const nodes: HTMLElement[] = [element("p", {}, sentence(preflight)), report];
  if (preflight.chosen.without.length > 0) {
    const take = element("button", { type: "button" }, "Take the simpler scene");
    take.addEventListener("click", onTake);
    nodes.push(take);
  }
  return nodes;
}

/** The conclusion, for people. */
export function sentence(preflight: PreflightReport): string {
  if (preflight.pilot.heavy_tails) return "Rare samples carry the noise, so nothing here is to be trusted, and nothing is chosen.";
  const target = `${Number((100 * preflight.error).toPrecision(3))} %`;
  const time = preflight.chosen.cpu_seconds === null ? "–" : formatDuration(preflight.chosen.cpu_seconds);
  const cost = `${(preflight.chosen.samples ?? 0).toLocaleString("en")} samples, ${time} of one processor.`;
  if (preflight.chosen.without.length === 0) return `Nothing simpler is known to be faster within ${target}: ${cost}`;
  return `Enough for ${target}: ${preflight.chosen.without.join(", ")}; ${preflight.saving.toFixed(1)} times faster. ${cost}`;
}

function cellsOf(model: PreflightModel): string[] {
  const time = model.cpu_seconds === null ? "–" : formatDuration(model.cpu_seconds);
  return [signed(model.mean_bias), between(model.local_bias), percent(model.cost_ratio.value, 0), model.verdict, time];
}

const percent = (value: number, digits = 2): string => `${(100 * value).toFixed(digits)} %`;
const signed = ({ value, high }: Interval): string => `${value >= 0 ? "+" : "−"}${percent(Math.abs(value))} ± ${percent(high - value)}`;
const between = ({ value, low, high }: Interval): string => `${percent(value)} (${percent(low)} to ${percent(high)})`;
