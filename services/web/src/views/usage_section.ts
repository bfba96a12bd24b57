/** Who uses what share of the workers, and what it cost so far. */
import { element, scroller } from "../dom.ts";
import { formatCount, formatMoney, formatValue } from "../format.ts";
import { getUsage } from "../service/client.ts";
import type { Usage } from "../service/types.ts";

export function usageSection(): { node: HTMLElement; load: () => Promise<void> } {
  const content = scroller("workers", "Table of owners");
  const node = element("section", { "aria-labelledby": "usage-title" }, element("h2", { id: "usage-title" }, "Who uses them"), content);
  return { node, load: async () => { content.replaceChildren(table(await getUsage())); } };
}

function table({ owners, core_hour_price, currency }: Usage): HTMLElement {
  if (owners.length === 0) return element("p", { class: "muted" }, "Nobody yet.");
  const priced = core_hour_price > 0;
  const headings = ["Owner", "Share now", "Weight", "Not ended", "Renders", "Core hours", ...(priced ? ["Cost"] : []), "On disk"];
  const rows = owners.map((each) => {
    const hours = each.cpu_seconds > 0 ? formatValue(each.cpu_seconds / 3600, 3) : "0";
    const cells = [`${(100 * each.share).toFixed(0)} %`, `${each.weight}`, `${each.open_renders}`, `${each.renders}`, hours, ...(priced ? [formatMoney(each.cost, currency)] : []), `${formatCount(each.stored_bytes)}B`];
    return element("tr", {}, element("th", { scope: "row" }, each.owner || "everybody"), ...cells.map((text) => element("td", {}, text)));
  });
  const head = element("tr", {}, ...headings.map((text) => element("th", { scope: "col" }, text)));
  const note = element("p", { class: "note" }, `Jobs in the hands of workers, and processor time of all renders, deleted ones included${priced ? `; an hour costs ${formatMoney(core_hour_price, currency)}` : ""}.`);
  return element("div", {}, element("table", {}, element("thead", {}, head), element("tbody", {}, ...rows)), note);
}
