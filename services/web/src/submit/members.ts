/** What is other than in the scene, as it stands in the form's fields, in the words of a group request. Pure. */
import type { CreateGroupRequest } from "../service/types.ts";

export interface Wanted {
  /** FIRST-LAST; empty: no frames. */
  frames: string;
  /** PLACE=VALUE, one a line; in frames FROM..TO goes evenly from the first to the last. */
  changes: string;
  /** PLACE=ONE,ANOTHER, one a line. */
  varied: string;
  /** FIRST:LAST:WIDTH in nm; empty: none. */
  bands: string;
  /** Direct and indirect light as channels. */
  parts?: boolean;
}

type Change = [place: string, value: unknown];

/** Throws Error, fit to be shown. */
export function membersOf({ frames, changes, varied, bands, parts }: Wanted): Required<Pick<CreateGroupRequest, "changes" | "varied" | "frames">> {
  const fixed = [...linesOf(changes).map(changeOf), ...bandsOf(bands), ...(parts ? [["sensor.light_parts", true] satisfies Change] : [])];
  return { changes: Object.fromEntries(fixed), varied: linesOf(varied).map(variationOf), frames: framesOf(frames) };
}

function linesOf(text: string): string[] {
  return text.split("\n").map((line) => line.trim()).filter(Boolean);
}

/** What is no JSON is text. */
function changeOf(text: string): Change {
  const [, place, value] = /^([^=]+)=(.*)$/.exec(text) ?? [];
  if (place === undefined || value === undefined) throw new Error(`${text}: expected a place and a value, such as sensor.position[0]=1.5`);
  return [place.trim(), jsonOr(value, value.trim())];
}

function variationOf(text: string): { place: string; values: unknown[] } {
  const [place, value] = [changeOf(text)[0], text.slice(text.indexOf("=") + 1)];
  const values = jsonOr(`[${value}]`, undefined) as unknown[] | undefined;
  return { place, values: values ?? value.split(",").map((each) => jsonOr(each, each.trim())) };
}

function jsonOr(text: string, otherwise: unknown): unknown {
  try {
    return JSON.parse(text) as unknown;
  } catch {
    return otherwise;
  }
}

function framesOf(text: string): { first: number; last: number } | null {
  if (!text.trim()) return null;
  const [, first, last] = (/^(\d+)-(\d+)$/.exec(text.trim()) ?? []).map(Number);
  if (first === undefined || last === undefined) throw new Error(`Frames ${text}: expected FIRST-LAST, such as 1-240`);
  return { first, last };
}

function bandsOf(text: string): Change[] {
  if (!text.trim()) return [];
  const [, first, last, width] = (/^(\d+):(\d+):(\d+)$/.exec(text.trim()) ?? []).map(Number);
  if (width === undefined) throw new Error(`Bands ${text}: expected FIRST:LAST:WIDTH in nm, such as 380:780:10`);
  return [["sensor.bands", { first, last, width }]];
}
