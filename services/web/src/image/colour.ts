/** Colorimetry of the CIE 1931 observer. Pure. Matrices are row by row. */

export type Triple = [number, number, number];
export type Matrix = [Triple, Triple, Triple];

/** White points with Y = 1: ASTM E308 for D65 and D50. */
export const whites = {
  D65: [0.95047, 1, 1.08883],
  D50: [0.96422, 1, 0.82521],
  E: [1, 1, 1],
} satisfies Record<string, Triple>;

/** IEC 61966-2-1: XYZ of white D65 to linear sRGB. */
export const xyzToSrgb: Matrix = [
  [3.2406, -1.5372, -0.4986],
  [-0.9689, 1.8758, 0.0415],
  [0.0557, -0.204, 1.057],
];

/** K. M. Lam's cone responses (Bradford, 1985). */
const bradford: Matrix = [
  [0.8951, 0.2664, -0.1614],
  [-0.7502, 1.7135, 0.0367],
  [0.0389, -0.0685, 1.0296],
];

/** Takes what is seen under white `from` to what looks alike under white `to`. */
export function adaptation(from: Triple, to: Triple): Matrix {
  const a = apply(bradford, from);
  const b = apply(bradford, to);
  const scaled = bradford.map((row, i) => row.map((value) => (value * (b[i] ?? 1)) / (a[i] ?? 1))) as Matrix;
  return product(inverse(bradford), scaled);
}

/** XYZ seen under `white` to linear sRGB, whose white is D65. */
export function displayMatrix(white: Triple): Matrix {
  return product(xyzToSrgb, adaptation(white, whites.D65));
}

export function chromaticity([X, Y, Z]: Triple): { x: number; y: number } | undefined {
  const sum = X + Y + Z;
  return sum > 0 ? { x: X / sum, y: Y / sum } : undefined;
}

/** How far from the locus of black bodies a correlated colour temperature still says something (CIE 15:2018). */
const farthest = 0.05;

/**
 * Correlated colour temperature in kelvin by C. S. McCamy (1992), good to a few kelvin from 2856 K to 6500 K;
 * undefined where the colour is too far from any black body, and outside 1500 K to 25000 K.
 */
export function colourTemperature({ x, y }: { x: number; y: number }): number | undefined {
  if (Math.abs(distanceFromLocus({ x, y })) > farthest) return undefined;
  const n = (x - 0.332) / (0.1858 - y);
  const kelvin = 449 * n ** 3 + 3525 * n ** 2 + 6823.3 * n + 5520.33;
  return kelvin >= 1500 && kelvin <= 25000 ? kelvin : undefined;
}

/** Duv, the distance from the Planckian locus in CIE 1960 uv, above it positive: ANSI C78.377-2011, after Y. Ohno. */
export function distanceFromLocus({ x, y }: { x: number; y: number }): number {
  const scale = -2 * x + 12 * y + 3;
  const u = (4 * x) / scale - 0.292;
  const v = (6 * y) / scale - 0.24;
  const length = Math.hypot(u, v);
  const a = Math.acos(u / length);
  const locus = [-0.471106, 1.925865, -2.4243787, 1.5317403, -0.5179722, 0.0893944, -0.00616793];
  return length - locus.reduceRight((sum, coefficient) => sum * a + coefficient, 0);
}

/** The sRGB curve, linear 0 to 1 to encoded 0 to 1. */
export function encodeSrgb(linear: number): number {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * linear ** (1 / 2.4) - 0.055;
}

export function apply(matrix: Matrix, [a, b, c]: Triple): Triple {
  return matrix.map((row) => row[0] * a + row[1] * b + row[2] * c) as Triple;
}

export function product(left: Matrix, right: Matrix): Matrix {
  const columns = [0, 1, 2].map((j) => apply(left, right.map((row) => row[j] ?? 0) as Triple));
  return [0, 1, 2].map((i) => columns.map((column) => column[i] ?? 0)) as Matrix;
}

/** By cofactors. */
export function inverse(m: Matrix): Matrix {
  const cofactor = (i: number, j: number): number => {
    const at = (row: number, column: number): number => m[(i + row) % 3]?.[(j + column) % 3] ?? 0;
    return at(1, 1) * at(2, 2) - at(1, 2) * at(2, 1);
  };
  const determinant = m[0][0] * cofactor(0, 0) + m[0][1] * cofactor(0, 1) + m[0][2] * cofactor(0, 2);
  return [0, 1, 2].map((i) => [0, 1, 2].map((j) => cofactor(j, i) / determinant)) as Matrix;
}
