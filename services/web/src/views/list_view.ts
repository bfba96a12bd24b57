/** The list of renders, newest first. */
import { element } from "../dom.ts";
import type { Renders } from "../service/renders.ts";
import { listItem, type ListItem } from "./list_item.ts";
import type { View } from "./view.ts";
import { workersSection } from "./workers_section.ts";

export function listView(renders: Renders): View {
  const list = element("ul", { class: "renders" });
  const empty = emptyState();
  const more = element("button", { type: "button", class: "more" }, "Show older renders");
  const workers = workersSection();
  const node = element("div", {}, element("h1", { tabindex: "-1" }, "Renders"), empty, list, more, workers.node);
  const items = new Map<string, ListItem>();

  more.addEventListener("click", () => {
    // A failed page leaves the button, to be pressed again.
    renders.fetchNextPage().catch(() => undefined);
  });

  const update = (): void => {
    const newest = renders.newestFirst();
    newest.forEach((render, index) => {
      const item = items.get(render.id) ?? listItem();
      items.set(render.id, item);
      item.show(render);
      // Moving a node loses its focus: only when it is out of place.
      if (list.children[index] !== item.node) list.insertBefore(item.node, list.children[index] ?? null);
    });
    for (const [id, item] of items) {
      if (renders.get(id)) continue;
      item.node.remove();
      items.delete(id);
    }
    empty.hidden = !renders.loaded || newest.length > 0;
    list.hidden = newest.length === 0;
    more.hidden = renders.nextPageToken === "";
  };
  const unsubscribe = renders.subscribe(update);
  update();

  return {
    node,
    title: "Renders",
    close: () => {
      unsubscribe();
      workers.close();
    },
  };
}

function emptyState(): HTMLElement {
  return element(
    "div",
    { class: "empty" },
    element("p", {}, "No renders yet. Submit one:"),
    element("pre", {}, element("code", {}, "nocturne submit scenes/cornell/scene.json")),
  );
}
