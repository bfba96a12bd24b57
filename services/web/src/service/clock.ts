/** The service's clock, so that elapsed times are right in a browser whose clock is wrong. */

/** The Date header has whole seconds and travels a while: smaller differences say nothing. */
const unremarkable_s = 3;

let offset_s = 0;

/** Learns the difference of the clocks from an answer's Date header. */
export function observeDate(header: string | null): void {
  const server_s = header === null ? NaN : Date.parse(header) / 1000;
  if (Number.isNaN(server_s)) return;
  const difference = server_s - Date.now() / 1000;
  offset_s = Math.abs(difference) < unremarkable_s ? 0 : difference;
}

/** Unix time now by the service's clock, seconds. */
export function serviceNow(): number {
  return Date.now() / 1000 + offset_s;
}

/** Seconds from start to end, or to now while it runs; 0 before the start. */
export function elapsedSeconds(times: { started: number; ended: number }): number {
  if (times.started === 0) return 0;
  return Math.max(0, (times.ended || serviceNow()) - times.started);
}
