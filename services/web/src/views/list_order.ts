/** Which renders a list shows, and in which order. Pure. */
import { hasEnded, type Render } from "../service/types.ts";

export const orders = { newest: "Newest first", name: "Name", error: "Largest error first", finish: "Next to finish", cost: "Most CPU time first" };
export type Order = keyof typeof orders;

export const kinds = { all: "All states", open: "Not ended", ended: "Ended" };
export type Kind = keyof typeof kinds;

export interface Wish {
  text: string;
  kind: Kind;
  order: Order;
  /** Of this group only; empty: of any. */
  group: string;
}

/** As the part of the address after "?" says; what it says wrongly is left out. */
export function wishOf(text: string, group: string): Wish {
  const query = new URLSearchParams(text);
  const [kind, order] = [query.get("show") ?? "", query.get("order") ?? ""];
  return { text: query.get("find") ?? "", kind: Object.hasOwn(kinds, kind) ? (kind as Kind) : "all", order: Object.hasOwn(orders, order) ? (order as Order) : "newest", group };
}

/** And back; what is usual is left out. */
export function queryOf({ text, kind, order }: Wish): string {
  const query = new URLSearchParams();
  if (text) query.set("find", text);
  if (kind !== "all") query.set("show", kind);
  if (order !== "newest") query.set("order", order);
  return query.toString();
}

/** Those that are wished for, of renders that come newest first. */
export function listed(renders: readonly Render[], { text, kind, order, group }: Wish): Render[] {
  const words = text.toLowerCase().split(/\s+/).filter(Boolean);
  const found = renders.filter((render) => {
    const about = `${render.name} ${render.id} ${render.owner} ${render.state} ${render.group} ${render.tags.join(" ")}`.toLowerCase();
    return (group === "" || render.group === group) && words.every((word) => about.includes(word)) && (kind === "all" || hasEnded(render) === (kind === "ended"));
  });
  return order === "newest" ? found : found.toSorted(comparisons[order]);
}

const comparisons: Record<Exclude<Order, "newest">, (a: Render, b: Render) => number> = {
  name: (a, b) => a.name.localeCompare(b.name),
  error: (a, b) => b.progress.relative_error - a.progress.relative_error,
  finish: (a, b) => finish(a) - finish(b),
  cost: (a, b) => b.progress.cpu_seconds - a.progress.cpu_seconds,
};

/** Those that have ended come after all that have a forecast. */
function finish(render: Render): number {
  if (hasEnded(render)) return 1e15 - render.ended;
  return render.progress.predicted_end || 1e14;
}
