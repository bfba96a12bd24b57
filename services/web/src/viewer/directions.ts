/** Directions about a surface on a disc of radius 1, in equal areas (Lambert's azimuthal projection). Pure. */

type Vector = readonly number[];

/** Points of a cone's rim. */
const points = 24;

/**
 * The rim of a cone. The middle of the disc is the surface's normal, its edge is grazing incidence, and its top is
 * the direction away from the origin of a ray along `direction`. Directions from below are put on the edge.
 */
export function outlineOf({ axis, half_angle_degrees: degrees }: { axis: Vector; half_angle_degrees: number }, normal: Vector, direction: Vector): [number, number][] {
  const [right, up] = frameOf(normal, direction);
  const [one, other] = tangentsOf(axis);
  const angle = (degrees * Math.PI) / 180;
  return Array.from({ length: points }, (_, i) => {
    const turn = (2 * Math.PI * i) / points;
    const rim = sum([Math.cos(angle), axis], [Math.sin(angle) * Math.cos(turn), one], [Math.sin(angle) * Math.sin(turn), other]);
    const [x, y, z] = [dot(rim, right), dot(rim, up), Math.max(0, dot(rim, normal))];
    const across = Math.hypot(x, y);
    // r = sqrt(2) sin(theta / 2), so that r^2 = 1 - cos(theta).
    const scale = across > 0 ? Math.sqrt(1 - Math.min(1, z)) / across : 0;
    // Down is where y grows on a page.
    return [scale * x, -scale * y];
  });
}

/** To the right and to the top of the disc. */
function frameOf(normal: Vector, direction: Vector): [Vector, Vector] {
  const along = sum([1, direction], [-dot(direction, normal), normal]);
  const length = Math.hypot(...along);
  // Looked at squarely, any side is up.
  const up = length > 1e-6 ? along.map((each) => each / length) : tangentsOf(normal)[0];
  return [cross(up, normal), up];
}

function tangentsOf(axis: Vector): [Vector, Vector] {
  const helper = Math.abs(axis[0] ?? 0) < 0.9 ? [1, 0, 0] : [0, 1, 0];
  const one = cross(axis, helper);
  const length = Math.hypot(...one);
  const unit = one.map((each) => each / length);
  return [unit, cross(axis, unit)];
}

function sum(...terms: [number, Vector][]): Vector {
  return [0, 1, 2].map((i) => terms.reduce((total, [factor, vector]) => total + factor * (vector[i] ?? 0), 0));
}

function dot(one: Vector, other: Vector): number {
  return one.reduce((total, each, i) => total + each * (other[i] ?? 0), 0);
}

function cross([a = 0, b = 0, c = 0]: Vector, [d = 0, e = 0, f = 0]: Vector): Vector {
  return [b * f - c * e, c * d - a * f, a * e - b * d];
}
