/** One render: its image, figures, error over time, and who works. */
import { announce, element, setText } from "../dom.ts";
import { formatState } from "../format.ts";
import { imageAddress, previewAddress, ServiceError } from "../service/client.ts";
import type { Renders } from "../service/renders.ts";
import { hasEnded, hasImage, type Render, type RenderState } from "../service/types.ts";
import { cancelButton } from "./cancel_button.ts";
import { convergenceSection } from "./convergence_section.ts";
import { factsList } from "./facts.ts";
import { picture } from "./picture.ts";
import { progressBar } from "./progress_bar.ts";
import { stateBadge } from "./state_badge.ts";
import type { View } from "./view.ts";
import { workersSection } from "./workers_section.ts";

export function renderView(id: string, renders: Renders): View {
  const panel = summaryPanel(id, renders);
  const image = picture(id);
  const convergence = convergenceSection(id);
  const workers = workersSection();
  const problem = element("p", { class: "problem", role: "alert" });
  const content = element(
    "div",
    { class: "render" },
    image.node,
    panel.node,
    element("div", { class: "below" }, convergence.node, workers.node),
  );
  const node = element("div", {}, element("p", { class: "back" }, element("a", { href: "#/" }, "← All renders")), panel.heading, problem, content);
  const follow = followChanges(id, renders, {
    onConnected: () => {
      convergence.reload();
      renders.fetch(id).catch((error: unknown) => {
        // Without an answer the bar says "reconnecting", and the next connection asks again.
        if (error instanceof ServiceError) setText(problem, `This render cannot be shown: ${error.message}`);
      });
    },
    onChange: (render) => {
      setText(problem, "");
      panel.show(render);
      image.show(render);
      convergence.show(render);
    },
    onEnd: convergence.reload,
    onNothing: (nothing) => {
      content.hidden = nothing;
    },
  });

  return {
    node,
    title: renders.get(id)?.name ?? "Render",
    close: () => {
      follow();
      image.close();
      convergence.close();
      workers.close();
    },
  };
}

interface Reactions {
  /** The event stream is there, for the first time or again. */
  onConnected: () => void;
  onChange: (render: Render) => void;
  onEnd: () => void;
  onNothing: (nothing: boolean) => void;
}

/** Calls the reactions as the render changes; returns what stops it. */
function followChanges(id: string, renders: Renders, reactions: Reactions): () => void {
  let connections = 0;
  let shown: Render | undefined;
  let state: RenderState | undefined;
  const update = (): void => {
    if (renders.connections !== connections) {
      connections = renders.connections;
      reactions.onConnected();
    }
    const render = renders.get(id);
    reactions.onNothing(render === undefined);
    if (!render || render === shown) return;
    shown = render;
    reactions.onChange(render);
    if (state !== undefined && state !== render.state) {
      announce(`${render.name}: ${formatState(render.state)}`);
      if (hasEnded(render)) reactions.onEnd();
    }
    state = render.state;
  };
  const unsubscribe = renders.subscribe(update);
  update();
  return unsubscribe;
}

/** The heading, and beside the image: progress, figures, downloads and cancel. */
function summaryPanel(id: string, renders: Renders): { heading: HTMLElement; node: HTMLElement; show: (render: Render) => void } {
  const name = element("span", {}, "Render");
  const badge = stateBadge();
  const reason = element("p", { class: "reason" });
  const bar = progressBar();
  const facts = factsList();
  const links = downloads(id);
  const cancel = cancelButton(id, (render) => {
    renders.put(render);
  });
  let current: Render | undefined;
  // Elapsed time grows between events too.
  const timer = setInterval(() => {
    if (!node.isConnected) clearInterval(timer);
    else if (current && !hasEnded(current)) facts.show(current);
  }, 1000);
  const node = element("aside", { "aria-label": "Figures" }, reason, bar.node, facts.node, links.node, cancel.button, cancel.dialog);

  const show = (render: Render): void => {
    current = render;
    setText(name, render.name || render.id);
    document.title = `${name.textContent} – Nocturne`;
    badge.show(render.state);
    setText(reason, render.reason);
    reason.hidden = render.reason === "";
    bar.show(render);
    facts.show(render);
    links.show(render);
    cancel.button.hidden = hasEnded(render);
  };
  return { heading: element("h1", { tabindex: "-1" }, name, badge.node), node, show };
}

/** Links to the image; the EXR is written when the render ends. */
function downloads(id: string): { node: HTMLElement; show: (render: Render) => void } {
  const file = `nocturne-${id.slice(0, 12)}`;
  const exr = element("a", { href: imageAddress(id), download: `${file}.exr` }, "Download EXR");
  const png = element("a", { href: previewAddress(id), download: `${file}.png` }, "Download PNG");
  const node = element("p", { class: "downloads" }, exr, png);
  return {
    node,
    show: (render) => {
      node.hidden = !hasImage(render);
      exr.hidden = !hasEnded(render);
    },
  };
}
