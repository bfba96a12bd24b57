/** Outlines as people type them. Pure. */
import type { Measurements, Outline, Render } from "../service/types.ts";

export type Kind = Outline["kind"];

export const kinds: Record<Kind, string> = { rectangle: "Region", polygon: "Polygon", line: "Line" };

const least: Record<Kind, number> = { rectangle: 2, polygon: 3, line: 2 };

/** "8,8 24,24" as points; throws Error, fit to be shown, where it is none. */
export function parsePoints(kind: Kind, text: string): number[][] {
  const parts = text.trim().split(/[\s,;]+/).filter(Boolean).map(Number);
  const points = parts.flatMap((x, index) => (index % 2 === 0 ? [[x, parts[index + 1] ?? NaN]] : []));
  const wrong = parts.some((part) => !Number.isFinite(part)) || points.some(([, y]) => !Number.isFinite(y)) || points.length < least[kind] || (kind !== "polygon" && points.length !== 2);
  if (wrong) throw new Error(kind === "polygon" ? "Expected three corners or more: 0,0 64,0 64,64" : "Expected two points: 8,8 24,24");
  return points;
}

export function pointsText(points: readonly (readonly number[])[]): string {
  return points.map((point) => point.map((value) => Number(value.toFixed(1))).join(",")).join(" ");
}

/** Whether nothing is kept, and the service measured all of the image. */
export function isWhole({ measurements }: Measurements, { width, height }: Pick<Render, "width" | "height">): boolean {
  const [only, more] = measurements.map(({ outline }) => outline);
  return only !== undefined && !more && only.name === "" && only.kind === "rectangle" && pointsText(only.points) === `0,0 ${width},${height}`;
}
