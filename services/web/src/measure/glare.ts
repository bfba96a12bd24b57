/** A glare rating as text, and where its sources are on a panorama's film, as outlines to draw. Pure. */
import { formatValue, plusMinus } from "../format.ts";
import type { Glare, Outline, Render } from "../service/types.ts";

/** The most pixels of which the service rates glare. */
const mostPixels = 2 ** 22;

/** Whether the service rates glare of such a render; of others it refuses to. */
export function hasGlare({ sensor, width, height }: Pick<Render, "sensor" | "width" | "height">): boolean {
  return sensor === "panorama" && width * height <= mostPixels;
}

export function glareText({ ugr, ugr_error: ugrError, dgp, dgp_error: dgpError, vertical_illuminance: lux, notes }: Glare): string {
  const rating = ugr === null ? "UGR is not known" : `UGR ${withError(ugr.toFixed(1), ugrError)}`;
  const probability = dgp === null ? "" : `, DGP ${withError(dgp.toFixed(3), dgpError)}`;
  const limits = notes.length > 0 ? ` (${notes.join("; ")})` : "";
  return `Glare for who looks at the middle: ${rating}${probability}, ${formatValue(lux, 4)} lx at the eye.${limits}`;
}

function withError(value: string, error: number | null): string {
  return error === null ? value : `${value} ${plusMinus(error)} (95\u00a0%)`;
}

const corners = 16;
/** Smaller circles would not be seen, pixels of the film. */
const leastRadius = 1.5;

/** A circle of each source's solid angle, with its number in the order of the list; of who looks at the middle. */
export function glareMarks({ sources }: Pick<Glare, "sources">, { width, height }: Pick<Render, "width" | "height">): Outline[] {
  const perDegree = width / 360;
  return sources.map(({ azimuth_degrees: azimuth, elevation_degrees: elevation, solid_angle: solidAngle }, index) => {
    const radius = Math.max(leastRadius, ((Math.sqrt(solidAngle / Math.PI) * 180) / Math.PI) * perDegree);
    const x = width / 2 + azimuth * perDegree;
    const y = height / 2 - elevation * perDegree;
    // Circles on the sphere are wider in a panorama, the farther from the horizon.
    const wider = Math.min(4, 1 / Math.max(0.25, Math.cos((elevation * Math.PI) / 180)));
    const points = Array.from({ length: corners }, (_, corner) => {
      const angle = (2 * Math.PI * corner) / corners;
      return [x + radius * wider * Math.cos(angle), y + radius * Math.sin(angle)];
    });
    return { name: `${index + 1}`, kind: "polygon" as const, points };
  });
}
