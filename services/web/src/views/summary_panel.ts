/** The heading, and beside the image: progress, figures, downloads, cancel and delete. */
import { element, setText } from "../dom.ts";
import { derivedAddress, getExplanation, previewAddress, sceneAddress } from "../service/client.ts";
import type { Renders } from "../service/renders.ts";
import { hasEnded, hasImage, type Render } from "../service/types.ts";
import { cancelButton, deleteButton } from "./ask_button.ts";
import { controlBar } from "./control_bar.ts";
import { factsList } from "./facts.ts";
import { idLine, progressBar, stateBadge } from "./render_parts.ts";

export function summaryPanel(id: string, renders: Renders): { heading: HTMLElement; node: HTMLElement; show: (render: Render) => void } {
  const name = element("span", {}, "Render");
  const badge = stateBadge();
  const reason = element("p", { class: "reason" });
  const warnings = element("ul", { class: "warnings", "aria-label": "Warnings" });
  const miss = element("p", { class: "out-of-reach", role: "status" });
  const way = element("p", { class: "way" });
  const bar = progressBar();
  const facts = factsList();
  const links = downloads(id);
  const controls = controlBar(id, (render) => { renders.put(render); });
  const cancel = cancelButton(id, (render) => { renders.put(render); });
  const remove = deleteButton(id, () => {
    renders.forget(id);
    location.hash = "#/";
  });
  let current: Render | undefined;
  // Elapsed time grows between events too.
  const timer = setInterval(() => {
    if (!node.isConnected) clearInterval(timer);
    else if (current && !hasEnded(current)) facts.show(current);
  }, 1000);
  const node = element("aside", { "aria-label": "Figures" }, reason, miss, warnings, way, bar.node, facts.node, idLine(id), links.node, controls.node, cancel.button, cancel.dialog, remove.button, remove.dialog);

  const show = (render: Render): void => {
    const waits = !hasEnded(render) && !hasImage(render);
    if (waits && render.state !== current?.state) void explain(id, reason);
    current = render;
    setText(name, render.name || render.id);
    document.title = `${name.textContent} – Nocturne`;
    badge.show(render.state);
    if (!waits) setText(reason, render.reason);
    reason.hidden = reason.textContent === "";
    setText(miss, render.target_unreachable);
    miss.hidden = render.target_unreachable === "";
    warnings.replaceChildren(...render.warnings.map(({ sentence }) => element("li", {}, sentence)));
    warnings.hidden = render.warnings.length === 0;
    setText(way, render.way === "" ? "" : `Traced by ${render.way}.`);
    way.hidden = render.way === "";
    bar.show(render);
    facts.show(render);
    links.show(render);
    controls.show(render);
    cancel.button.hidden = hasEnded(render);
    remove.button.hidden = !hasEnded(render);
  };
  return { heading: element("h1", { tabindex: "-1" }, name, badge.node), node, show };
}

/** What a render without samples waits for. */
async function explain(id: string, node: HTMLElement): Promise<void> {
  try {
    setText(node, await getExplanation(id));
    node.hidden = false;
  } catch {
    // The bar says that the service is out of reach.
  }
}

/** Links to the image as it is now, and to the scene. */
function downloads(id: string): { node: HTMLElement; show: (render: Render) => void } {
  const file = `nocturne-${id.slice(0, 12)}`;
  const exr = element("a", { href: derivedAddress(id, "image.exr"), download: `${file}.exr` }, "Download EXR");
  const png = element("a", { href: previewAddress(id), download: `${file}.png` }, "Download PNG");
  const scene = element("a", { href: sceneAddress(id), download: `${file}.json` }, "Scene");
  const log = element("a", { href: derivedAddress(id, "log.txt"), download: `${file}.txt` }, "Log");
  const bundle = element("a", { href: derivedAddress(id, "bundle.zip"), download: `${file}.zip`, title: "State, log, scene and failures, to ask somebody about it" }, "Bundle");
  const node = element("p", { class: "downloads" }, exr, png, scene, log, bundle);
  return {
    node,
    show: (render) => {
      exr.hidden = !hasImage(render);
      png.hidden = !hasImage(render);
    },
  };
}
