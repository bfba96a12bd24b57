/** Where sources of glare are on a panorama's film, as outlines to draw. Pure. */
import type { Glare, Outline, Render } from "../service/types.ts";

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
