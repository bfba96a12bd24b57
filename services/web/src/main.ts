/** Starts the page: one store of renders, one view at a time by the address. */
import { element, required, setText } from "./dom.ts";
import { getSession, signOut } from "./service/client.ts";
import { parseRoute } from "./router.ts";
import { notifyOfEnds } from "./service/notifier.ts";
import { loadPrice } from "./service/price.ts";
import { Renders } from "./service/renders.ts";
import "./style/page.css";
import "./style/list.css";
import "./style/render.css";
import "./style/viewer.css";
import "./style/submit.css";
import { listView } from "./views/list_view.ts";
import { compareView } from "./views/compare_view.ts";
import { renderView } from "./views/render_view.ts";
import { signInTitle, signInView } from "./views/sign_in_view.ts";
import { speedView } from "./views/speed_view.ts";
import type { View } from "./views/view.ts";
import { workersView } from "./views/workers_view.ts";

const renders = new Renders();
let current: View | undefined;
let signingIn = false;

function viewOf(hash: string): View {
  const route = parseRoute(hash);
  switch (route.page) {
    case "list":
      return listView(renders);
    case "group":
      return listView(renders, route.name);
    case "render":
      return renderView(route.id, renders);
    case "unknown":
      return notFound();
    case "compare":
      return compareView(route.first, route.second, renders);
    case "workers":
      return workersView();
    case "speed":
      return speedView(renders);
  }
}

function notFound(): View {
  const back = element("p", {}, element("a", { href: "#/" }, "All renders"));
  const node = element("div", {}, element("h1", { tabindex: "-1" }, "There is no such page"), back);
  return { node, title: "Not found", close: () => undefined };
}

/** What the address asks for. */
function open(): View {
  return openView(viewOf(location.hash));
}

function openView(view: View): View {
  current?.close();
  signingIn = view.title === signInTitle;
  document.title = `${view.title} – Nocturne`;
  required("content").replaceChildren(view.node);
  return view;
}

function signedIn(): void {
  required("sign-out").hidden = false;
  renders.start();
  loadPrice().catch(() => undefined);
  current = open();
}

function showConnection(): void {
  const words = { connecting: "Connecting…", live: "Live", reconnecting: "Connection lost, reconnecting…", "signed out": "Not signed in" };
  const node = required("connection");
  node.dataset.connection = renders.connection;
  setText(node, words[renders.connection]);
  if (renders.connection === "signed out" && !signingIn) current = openView(signInView(signedIn));
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
required("sign-out").addEventListener("click", () => void signOut().then(() => { location.reload(); }));
loadPrice().catch(() => undefined);
// Who has a name came with a token.
getSession().then(({ name }) => { required("sign-out").hidden = name === ""; }, () => undefined);
// An address as people type it, /renders/ID: the service answers all of these with this page.
if (location.pathname !== "/") history.replaceState(null, "", `/#${location.pathname}${location.search}`);
renders.subscribe(showConnection);
notifyOfEnds(renders);
showConnection();
current = open();
renders.start();
