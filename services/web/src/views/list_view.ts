/** The list of renders: filtered, in an order, and a place to submit another. */
import { element, oncePerFrame, setText } from "../dom.ts";
import { notifyBox } from "../service/notifier.ts";
import type { Renders } from "../service/renders.ts";
import { submitPanel } from "../submit/submit_panel.ts";
import type { Render } from "../service/types.ts";
import { select as choice } from "../viewer/controls.ts";
import { groupLine } from "./group_line.ts";
import { listItem, type ListItem } from "./list_item.ts";
import { type Kind, kinds, listed, type Order, orders, queryOf, type Wish, wishOf } from "./list_order.ts";
import { selectionBar } from "./selection_bar.ts";
import type { View } from "./view.ts";
import { workersSection } from "./workers_section.ts";

/** `group`: of one group only, with how far it is. */
export function listView(renders: Renders, group = ""): View {
  const list = element("ul", { class: "renders" });
  const empty = element("p", { class: "empty" });
  const more = element("button", { type: "button", class: "more" }, "Show older renders");
  const workers = workersSection();
  const submit = submitPanel();
  const wish = wishOf(location.hash.split("?")[1] ?? "", group);
  const line = group ? groupLine(group) : undefined;
  const items = new Map<string, ListItem>();

  const select = (): void => { selection.show(selected()); };
  const update = (): void => {
    const shown = listed(renders.newestFirst(), wish);
    place(list, items, shown.map((render) => {
      const item = items.get(render.id) ?? listItem(select);
      items.set(render.id, item);
      item.show(render);
      return item.node;
    }));
    for (const id of items.keys()) if (!renders.get(id)) items.delete(id);
    empty.hidden = !renders.loaded || shown.length > 0;
    setText(empty, renders.newestFirst().length > 0 ? "No render is like that." : "No renders yet. Submit one below, or with nocturne submit.");
    list.hidden = shown.length === 0;
    select();
    more.hidden = group !== "" || renders.nextPageToken === "";
    line?.refresh();
  };
  const selected = (): Render[] => renders.newestFirst().filter(({ id }) => items.get(id)?.box.checked);
  const selectAll = (checked: boolean): void => {
    for (const { node, box } of items.values()) box.checked = checked && node.isConnected;
    select();
  };
  const selection = selectionBar(renders, () => { selectAll(true); }, () => { selectAll(false); });
  const filters = filterBar(wish, update, (words) => renders.search(words));
  const heading = element("h1", { tabindex: "-1" }, group ? `Group ${group}` : "Renders");
  const head = line ? [element("p", { class: "back" }, element("a", { href: "#/" }, "← All renders")), heading, line.node] : [heading];
  const node = element("div", {}, ...head, filters, selection.node, empty, list, more, ...(line ? [] : [submit.node]), workers.node);
  if (group) renders.fetchGroup(group).catch(() => undefined);
  more.addEventListener("click", () => {
    // A failed page leaves the button, to be pressed again.
    renders.fetchNextPage().catch(() => undefined);
  });
  // Renders come one by one; their changes are shown at once.
  const unsubscribe = renders.subscribe(oncePerFrame(update));
  update();
  return {
    node,
    title: group || "Renders",
    close: () => {
      line?.close();
      unsubscribe();
      workers.close();
      submit.close();
    },
  };
}

/** Moving a node loses its focus: only when it is out of place. */
function place(list: HTMLElement, items: ReadonlyMap<string, ListItem>, nodes: HTMLElement[]): void {
  const wanted = new Set(nodes);
  for (const { node } of items.values()) if (!wanted.has(node)) node.remove();
  let next = list.firstChild;
  for (const node of nodes) {
    if (node === next) next = next.nextSibling;
    else list.insertBefore(node, next);
  }
}

/** `find` has the service look among all renders, once nobody types any more. */
function filterBar(wish: Wish, update: () => void, find: (words: string) => Promise<void>): HTMLElement {
  const search = element("input", { type: "search", placeholder: "Name, id, owner, state, group, tag", "aria-label": "Filter", value: wish.text });
  let timer: ReturnType<typeof setTimeout> | undefined;
  const changed = (): void => {
    const [route = ""] = location.hash.split("?");
    const query = queryOf(wish);
    history.replaceState(null, "", `${route === "" ? "#/" : route}${query && `?${query}`}`);
    update();
  };
  const look = (): void => {
    if (wish.text.trim()) find(wish.text).catch(() => undefined);
  };
  search.addEventListener("input", () => {
    wish.text = search.value;
    clearTimeout(timer);
    timer = setTimeout(look, 300);
    changed();
  });
  look();
  return element(
    "div",
    { class: "tools", role: "search" },
    search,
    choice("Show", Object.entries(kinds), wish.kind, (kind) => {
      wish.kind = kind as Kind;
      changed();
    }),
    choice("Order", Object.entries(orders), wish.order, (order) => {
      wish.order = order as Order;
      changed();
    }),
    notifyBox(),
  );
}
