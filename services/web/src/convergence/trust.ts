/** How far the estimate of the error may itself be wrong. Pure. */

/**
 * Two standard deviations of the error, relative to it. Its square is a mean over pixels; where n of them carry it, and each one's
 * variance is known about to itself (heavy tails), the mean is known to 1/sqrt(n), and its root to half of that.
 */
export function uncertainty(effectivePixels: number): number {
  return effectivePixels > 0 ? Math.min(1, 1 / Math.sqrt(effectivePixels)) : 0;
}
