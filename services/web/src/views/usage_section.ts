/** Who uses what share of the workers, and what it cost so far. */
import { element, scroller, section, table, tableRow } from "../dom.ts";
import { formatCount, formatMoney, formatValue } from "../format.ts";
import { getUsage } from "../service/client.ts";
import type { Usage } from "../service/types.ts";

export function usageSection(): { node: HTMLElement; load: () => Promise<void> } {
  const content = scroller("workers", "Table of owners");
  const node = section("usage", "Who uses them", content);
  return { node, load: async () => { content.replaceChildren(usageTable(await getUsage())); } };
}

function usageTable({ owners, core_hour_price, currency }: Usage): HTMLElement {
  if (owners.length === 0) return element("p", { class: "muted" }, "Nobody yet.");
  const priced = core_hour_price > 0;
  const headings = ["Owner", "Share now", "Weight", "Not ended", "Renders", "Core hours", ...(priced ? ["Cost"] : []), "On disk"];
  const rows = owners.map((each) => {
    const hours = each.cpu_seconds > 0 ? formatValue(each.cpu_seconds / 3600, 3) : "0";
    const cells = [`${(100 * each.share).toFixed(0)} %`, `${each.weight}`, `${each.open_renders}`, `${each.renders}`, hours, ...(priced ? [formatMoney(each.cost, currency)] : []), `${formatCount(each.stored_bytes)}B`];
    return tableRow(each.owner || "everybody", cells);
  });
  const note = element("p", { class: "note" }, `Jobs in the hands of workers, and processor time of all renders, deleted ones included${priced ? `; an hour costs ${formatMoney(core_hour_price, currency)}` : ""}.`);
  return element("div", {}, table(headings, rows), note);
}
