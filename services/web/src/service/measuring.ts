/** Photometry of renders, by the service. */
import type { Words } from "../measure/result.ts";
import type { Year } from "../measure/year.ts";
import { getJson, renderAddress } from "./client.ts";
import type { Glare, Isolines, MeasuredRegions, Measurements, Outline } from "./types.ts";

/** What the parts that are kept with a render show, or the whole image where none are. */
export async function measure(id: string, bins: number): Promise<Measurements> {
  return getJson<"measure">(`${renderAddress(id)}:measure`, { method: "POST", body: JSON.stringify({ bins, colour: true }) });
}

/** Keeps these parts with the render instead of all that were kept. */
export async function keepRegions(id: string, regions: readonly Outline[]): Promise<MeasuredRegions> {
  return getJson<"keep_regions">(`${renderAddress(id)}/regions`, { method: "PUT", body: JSON.stringify({ regions }) });
}

/** Without levels, at round numbers. */
export async function getIsolines(id: string, levels: readonly number[]): Promise<Isolines> {
  const query = new URLSearchParams(levels.map((level) => ["level", `${level}`]));
  return getJson<"get_isolines">(`${renderAddress(id)}/isolines?${query.toString()}`);
}

/** Of a panorama; others are refused. */
export async function getGlare(id: string): Promise<Glare> {
  return getJson<"get_glare">(`${renderAddress(id)}/glare`);
}

/** A year of daylight, of the group that a render of daylight coefficients is in. */
export async function getYear(id: string, query: string): Promise<Year> {
  // The description has no more than that it is JSON, as the command line writes it.
  return (await getJson<"get_annual">(`${renderAddress(id)}/annual.json?${query}`)) as unknown as Year;
}

/** What a report says of the light; takes seconds. */
export async function getReportWords(id: string, query: string): Promise<Words> {
  return (await getJson<"get_report_words">(`${renderAddress(id)}/report.json?${query}`)) as unknown as Words;
}
