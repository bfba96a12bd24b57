/** Curves of several renders for one chart: each one's error over its processor time. Pure. */
import type { ConvergencePoint, Render } from "../service/types.ts";

export interface Curves {
  x: number[];
  /** Of each render, beside x; null where it has no point. */
  columns: (number | null)[][];
}

const mostPoints = 60;

/** The history has the time of running; processor time goes with the samples. */
export function curvesOf(renders: readonly Render[], histories: readonly (readonly ConvergencePoint[])[]): Curves {
  const points = renders.map((render, index) => curveOf(render, histories[index] ?? []));
  const x = [...new Set(points.flatMap((curve) => curve.map(([seconds]) => seconds)))].sort((a, b) => a - b);
  const columns = points.map((curve) => {
    const bySeconds = new Map(curve);
    return x.map((seconds) => bySeconds.get(seconds) ?? null);
  });
  return { x, columns };
}

function curveOf({ progress }: Render, history: readonly ConvergencePoint[]): [number, number][] {
  if (progress.mean_samples <= 0 || progress.cpu_seconds <= 0) return [];
  const perSample = progress.cpu_seconds / progress.mean_samples;
  const known = history.filter(({ relative_error, samples }) => relative_error > 0 && samples > 0);
  const step = Math.max(1, Math.ceil(known.length / mostPoints));
  const thinned = known.filter((_, index) => index % step === 0).map(({ samples, relative_error }): [number, number] => [samples * perSample, relative_error]);
  const last: [number, number][] = progress.relative_error > 0 ? [[progress.cpu_seconds, progress.relative_error]] : [];
  return [...thinned, ...last];
}

/** Which renders are shown: those of the address, else the newest. */
export function chosenOf(renders: readonly Render[], asked: readonly string[], most = 6): Render[] {
  const found = renders.filter(({ id }) => asked.includes(id));
  return found.length > 0 ? found : renders.slice(0, most);
}
