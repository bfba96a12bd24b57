/** Colour maps, and the numbers that go beside them. Pure. */

/** Perceptually even from dark to light: viridis, by N. Smith and S. van der Walt (CC0), at eight places. */
const viridis = [0x440154, 0x46327e, 0x365c8d, 0x277f8e, 0x1fa187, 0x4ac16d, 0xa0da39, 0xfde725];

/** Blue below, white at zero, red above: RdBu of ColorBrewer 2.0 (C. Brewer), reversed. */
const diverging = [0x2166ac, 0x67a9cf, 0xd1e5f0, 0xf7f7f7, 0xfddbc7, 0xef8a62, 0xb2182b];

export const maps = { viridis, diverging };

export const mapSize = 256;

/** RGBA bytes of a map, linearly between its places. */
export function mapBytes(colours: readonly number[]): Uint8Array {
  const bytes = new Uint8Array(4 * mapSize);
  for (let i = 0; i < mapSize; i += 1) {
    const at = (i / (mapSize - 1)) * (colours.length - 1);
    const low = Math.min(colours.length - 2, Math.floor(at));
    for (let channel = 0; channel < 3; channel += 1) {
      const part = (index: number): number => ((colours[index] ?? 0) >> (16 - 8 * channel)) & 255;
      bytes[4 * i + channel] = Math.round(part(low) + (at - low) * (part(low + 1) - part(low)));
    }
    bytes[4 * i + 3] = 255;
  }
  return bytes;
}

export interface Scale {
  low: number;
  high: number;
  logarithmic: boolean;
}

/** From so many powers of ten on, numbers between these have no room. */
const manyDecades = 2.2;

/** Where on the scale, 0 to 1, its numbers go: powers of ten, with 2 and 5 times these where there is room, or five even steps. */
export function ticks({ low, high, logarithmic }: Scale): { at: number; value: number }[] {
  if (!logarithmic) return [0, 0.25, 0.5, 0.75, 1].map((at) => ({ at, value: low + at * (high - low) }));
  const span = Math.log10(high / low);
  const digits = span < manyDecades ? [1, 2, 5] : [1];
  const found = [];
  for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high) + 1e-9; power += 1) {
    for (const digit of digits) {
      const at = (power + Math.log10(digit) - Math.log10(low)) / span;
      if (at >= -1e-9 && at <= 1 + 1e-9) found.push({ at, value: digit * 10 ** power });
    }
  }
  return found.length > 1 ? found : [{ at: 0, value: low }, { at: 1, value: high }];
}

/** A logarithmic scale over whole powers of ten that has nearly all of the positive values. */
export function decades(values: Iterable<number>): Scale {
  const sorted = Float64Array.from([...values].filter((value) => value > 0)).sort();
  const quantile = (part: number): number => sorted[Math.floor(part * (sorted.length - 1))] ?? 1;
  const high = Math.ceil(Math.log10(quantile(0.999)) - 1e-9);
  const low = Math.min(high - 1, Math.max(high - 6, Math.floor(Math.log10(quantile(0.01)) + 1e-9)));
  return { low: 10 ** low, high: 10 ** high, logarithmic: true };
}
