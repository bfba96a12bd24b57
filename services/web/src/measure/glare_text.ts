/** A glare rating as text. Pure. */
import { formatValue } from "../format.ts";
import type { Glare, Render } from "../service/types.ts";

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
  return error === null ? value : `${value} ± ${formatValue(error, 2)}`;
}
