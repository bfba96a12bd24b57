/** Starts the page: one store of renders, one view at a time by the address. */
import { element, required, setText } from "./dom.ts";
import { parseRoute } from "./router.ts";
import { Renders } from "./service/renders.ts";
import "./style/page.css";
import "./style/list.css";
import "./style/render.css";
import { listView } from "./views/list_view.ts";
import { renderView } from "./views/render_view.ts";
import type { View } from "./views/view.ts";

const renders = new Renders();
let current: View | undefined;

function viewOf(hash: string): View {
  const route = parseRoute(hash);
  switch (route.page) {
    case "list":
      return listView(renders);
    case "render":
      return renderView(route.id, renders);
    case "unknown":
      return notFound();
  }
}

function notFound(): View {
  const back = element("p", {}, element("a", { href: "#/" }, "All renders"));
  const node = element("div", {}, element("h1", { tabindex: "-1" }, "There is no such page"), back);
  return { node, title: "Not found", close: () => undefined };
}

function open(): View {
  current?.close();
  const view = viewOf(location.hash);
  document.title = `${view.title} – Nocturne`;
  required("content").replaceChildren(view.node);
  return view;
}

function showConnection(): void {
  const words = { connecting: "Connecting…", live: "Live", reconnecting: "Connection lost, reconnecting…" };
  const node = required("connection");
  node.dataset.connection = renders.connection;
  setText(node, words[renders.connection]);
}

window.addEventListener("hashchange", () => {
  current = open();
  // Keyboards and screen readers start at the new page's heading.
  current.node.querySelector<HTMLElement>("h1")?.focus();
});
// The address after the hash is the route, so the skip link may not change it.
document.querySelector(".skip")?.addEventListener("click", (event) => {
  event.preventDefault();
  required("content").focus();
});
renders.subscribe(showConnection);
showConnection();
current = open();
renders.start();
