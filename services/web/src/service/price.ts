/** What an hour of a worker's processor costs, as who runs the service says; nothing until it is known. */
import { formatMoney } from "../format.ts";
import { getUsage } from "./client.ts";

let price = 0;
let currency = "";

export async function loadPrice(): Promise<void> {
  const usage = await getUsage();
  price = usage.core_hour_price;
  currency = usage.currency;
}

/** Of so much processor time; empty where no price is set. */
export function costOf(cpuSeconds: number): string {
  return price > 0 ? formatMoney((price * cpuSeconds) / 3600, currency) : "";
}
