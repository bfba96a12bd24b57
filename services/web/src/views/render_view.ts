/** One render: its image, figures, error over time, and who works. */
import { announce, element, setText } from "../dom.ts";
import { formatState } from "../format.ts";
import { compareRoute } from "../router.ts";
import { getBaselines, ServiceError } from "../service/client.ts";
import type { Renders } from "../service/renders.ts";
import { hasEnded, hasImage, type Render, type RenderState } from "../service/types.ts";
import { MeasurePanel } from "../measure/measure_panel.ts";
import { type RenderImage, renderImage } from "../viewer/render_image.ts";
import { convergenceSection } from "./convergence_section.ts";
import { denoisedSection } from "./denoised_section.ts";
import { lookFirstButton } from "./look_first_button.ts";
import { ResultSection } from "./result_section.ts";
import { summaryPanel } from "./summary_panel.ts";
import type { View } from "./view.ts";
import { workersSection } from "./workers_section.ts";
import { YearSection } from "./year_section.ts";

export function renderView(id: string, renders: Renders): View {
  const panel = summaryPanel(id, renders);
  const image = renderImage(id, {
    onChosen: () => { first.show(renders.get(id)); },
    onDrawn: (outline) => { measuring.draft(outline); },
    onTiles: () => { measuring.refresh(); },
  });
  const measuring = new MeasurePanel(id, image);
  const first = lookFirstButton(id, image.chosen, (render) => { renders.put(render); });
  image.node.append(first.node, measuring.node);
  const convergence = convergenceSection(id);
  const denoised = denoisedSection(id);
  const workers = workersSection({ id, onTilesInProgress: (byTile) => image.viewer?.showWorkers(byTile) });
  const results = [new ResultSection(id), new YearSection(id)];
  const problem = element("p", { class: "problem", role: "alert" });
  const below = element("div", { class: "below" }, convergence.node, workers.node, denoised.node);
  const content = element("div", { class: "render" }, ...results.map(({ node }) => node), image.node, panel.node, below);
  const links = linksOf(id);
  const node = element("div", {}, links, panel.heading, problem, content);
  const stop = [
    followChanges(id, renders, {
      onConnected: () => {
        convergence.reload();
        image.refresh();
      },
      onChange: (render) => {
        setText(problem, "");
        panel.show(render);
        for (const each of results) each.show(render);
        image.show(render);
        first.show(render);
        measuring.show(render);
        convergence.show(render);
        denoised.show(render);
      },
      onEnd: () => {
        convergence.reload();
        image.refresh();
      },
      onNothing: (nothing) => { content.hidden = nothing; },
    }),
    followTiles(id, renders, image),
    begin(id, renders, problem),
  ];
  return {
    node,
    title: renders.get(id)?.name ?? "Render",
    close: () => {
      for (const each of stop) each();
      image.close();
      measuring.close();
      convergence.close();
      workers.close();
    },
  };
}

/** Back, and to comparisons: with any other, and with the same scene by other engines. */
function linksOf(id: string): HTMLElement {
  const node = element("p", { class: "back" }, element("a", { href: "#/" }, "← All renders"), element("a", { href: compareRoute(id) }, "Compare…"));
  getBaselines(id).then(
    (found) => { node.append(...found.map((render) => element("a", { href: compareRoute(id, render.id) }, `Compare with engine ${render.engine}`))); },
    // The view shows the render's error.
    () => undefined,
  );
  return node;
}

/** Follows the render, if there is one, until the returned function is called. */
export function begin(id: string, renders: Renders, problem: HTMLElement): () => void {
  let closed = false;
  renders.fetch(id).then(
    () => { if (!closed) renders.watch([id]); },
    (error: unknown) => {
      if (error instanceof ServiceError && error.status !== 401) setText(problem, `This render cannot be shown: ${error.message}`);
      // Out of reach: the stream reconnects and then sends the current state.
      else if (!closed) renders.watch([id]);
    },
  );
  return () => {
    closed = true;
    renders.watch([]);
  };
}

function followTiles(id: string, renders: Renders, image: RenderImage): () => void {
  image.refresh();
  return renders.subscribeTiles((event) => {
    if (event.render === id) image.refresh();
  });
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
      if (hasEnded(render) && hasImage(render)) reactions.onEnd();
    }
    state = render.state;
  };
  const unsubscribe = renders.subscribe(update);
  update();
  return unsubscribe;
}
