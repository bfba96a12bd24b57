/** Many renders of one submission: variants and frames of a scene, and changes of it. As nocturne_client/sequences.py and changes.py. Pure. */
import type { SceneDocument } from "../service/types.ts";

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

export interface Member {
  /** What tells it from the others; empty where there are none. */
  name: string;
  document: SceneDocument;
}

type Change = [place: string, value: unknown];

const mostMembers = 1000;

/** The scene in every variant and frame; throws Error, fit to be shown. */
export function membersOf(document: SceneDocument, { frames, changes, varied, bands, parts }: Wanted): Member[] {
  const fixed = [...linesOf(changes).map(changeOf), ...bandsOf(bands), ...(parts ? [["sensor.light_parts", true] satisfies Change] : [])];
  const numbers = numbersOf(frames);
  const variants = linesOf(varied).map(valuesOf).reduce<Change[][]>((all, values) => all.flatMap((before) => values.map((value) => [...before, value])), [[]]);
  if (variants.length * numbers.length > mostMembers) throw new Error(`${variants.length * numbers.length} renders are too many to submit here; at most ${mostMembers}`);
  const digits = `${numbers.at(-1) ?? 0}`.length;
  return variants.flatMap((variant) => numbers.map((number, index) => {
    const part = numbers.length > 1 ? index / (numbers.length - 1) : undefined;
    const words = variant.map(([place, value]) => `${place.slice(place.lastIndexOf(".") + 1)}=${typeof value === "string" ? value : JSON.stringify(value)}`);
    if (frames.trim()) words.push(`${number}`.padStart(digits, "0"));
    return { name: words.join(" "), document: changed(document, [...fixed.map(([place, value]): Change => [place, between(value, part)]), ...variant]) };
  }));
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

function valuesOf(text: string): Change[] {
  const [place, value] = [changeOf(text)[0], text.slice(text.indexOf("=") + 1)];
  const values = jsonOr(`[${value}]`, undefined) as unknown[] | undefined;
  return (values ?? value.split(",").map((each) => jsonOr(each, each.trim()))).map((each): Change => [place, each]);
}

function jsonOr(text: string, otherwise: unknown): unknown {
  try {
    return JSON.parse(text) as unknown;
  } catch {
    return otherwise;
  }
}

function numbersOf(frames: string): number[] {
  if (!frames.trim()) return [0];
  const [, first = NaN, last = NaN] = (/^(\d+)-(\d+)$/.exec(frames.trim()) ?? []).map(Number);
  if (!(last >= first)) throw new Error(`Frames ${frames}: expected FIRST-LAST, such as 1-240`);
  if (last - first >= mostMembers) throw new Error(`Frames ${frames}: at most ${mostMembers} here`);
  return Array.from({ length: last - first + 1 }, (_, index) => first + index);
}

function bandsOf(text: string): Change[] {
  if (!text.trim()) return [];
  const [, first, last, width] = (/^(\d+):(\d+):(\d+)$/.exec(text.trim()) ?? []).map(Number);
  if (width === undefined) throw new Error(`Bands ${text}: expected FIRST:LAST:WIDTH in nm, such as 380:780:10`);
  return [["sensor.bands", { first, last, width }]];
}

/** 0..2.5 is a way from the first frame to the last. */
function between(value: unknown, part: number | undefined): unknown {
  if (part === undefined || typeof value !== "string") return value;
  const [, from, to] = /^([-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?)\.\.([-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?)$/i.exec(value.trim()) ?? [];
  return from === undefined || to === undefined ? value : Number(from) + part * (Number(to) - Number(from));
}

export function changed(document: SceneDocument, changes: Change[]): SceneDocument {
  if (changes.length === 0) return document;
  const made = structuredClone(document);
  for (const [place, value] of changes) put(made, stepsOf(place), value, place);
  return made;
}

function stepsOf(place: string): (string | number)[] {
  const path = place.replace(/^\$\./, "");
  const found = [...path.matchAll(/\.?([A-Za-z_][A-Za-z0-9_ -]*)|\[(\d+)\]/gy)];
  if (found.length === 0 || found.map(([text]) => text).join("") !== path) throw new Error(`${place} is no place in a scene, such as surfaces[2].kernel.reflectance`);
  return found.map(([, name, index]) => name ?? Number(index));
}

/** An object that is not there yet is made, as the default of most parts. */
function put(document: unknown, steps: (string | number)[], value: unknown, place: string): void {
  let at = document;
  steps.forEach((step, index) => {
    const isLast = index === steps.length - 1;
    const isList = Array.isArray(at);
    if (typeof at !== "object" || at === null || isList !== (typeof step === "number") || (Array.isArray(at) && Number(step) >= at.length)) throw new Error(`The scene has no ${place}`);
    const inside = at as Record<string | number, unknown>;
    if (isLast) inside[step] = value;
    else at = inside[step] ??= {};
  });
}
