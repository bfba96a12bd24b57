/** Exposure of an 8-bit sRGB picture: its values are made linear, multiplied and encoded again (IEC 61966-2-1). */

/** The byte shown for each byte of the preview, at an exposure in stops. */
export function exposureTable(stops: number): Uint8ClampedArray {
  const factor = 2 ** stops;
  return Uint8ClampedArray.from({ length: 256 }, (_, byte) => 255 * encode(Math.min(1, factor * decode(byte / 255))));
}

/** Writes `source` (RGBA) through the table into `target` of the same length; alpha is copied. */
export function applyExposure(source: Uint8ClampedArray, target: Uint8ClampedArray, table: Uint8ClampedArray): void {
  for (let i = 0; i < source.length; i += 4) {
    target[i] = table[source[i] ?? 0] ?? 0;
    target[i + 1] = table[source[i + 1] ?? 0] ?? 0;
    target[i + 2] = table[source[i + 2] ?? 0] ?? 0;
    target[i + 3] = source[i + 3] ?? 0;
  }
}

function decode(value: number): number {
  return value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4;
}

function encode(value: number): number {
  return value <= 0.0031308 ? 12.92 * value : 1.055 * value ** (1 / 2.4) - 0.055;
}
