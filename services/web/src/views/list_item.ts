/** One render in the list. */
import { element, setText } from "../dom.ts";
import { formatRelativeError, formatSamples } from "../format.ts";
import { renderRoute } from "../router.ts";
import type { Render } from "../service/types.ts";
import { progressBar } from "./progress_bar.ts";
import { stateBadge } from "./state_badge.ts";
import { thumbnail } from "./thumbnail.ts";

export interface ListItem {
  node: HTMLElement;
  show: (render: Render) => void;
}

export function listItem(): ListItem {
  const picture = thumbnail();
  const link = element("a", { class: "name" });
  const badge = stateBadge();
  const size = element("span");
  const bar = progressBar();
  const error = element("span", { class: "error", title: "Relative standard error" });
  const node = element(
    "li",
    {},
    picture.node,
    element("div", { class: "what" }, element("h2", {}, link, badge.node), size),
    element("div", { class: "how-far" }, bar.node, error),
  );

  const show = (render: Render): void => {
    link.href = renderRoute(render.id);
    setText(link, render.name || render.id);
    badge.show(render.state);
    setText(size, `${render.width} × ${render.height} · ${samplesShort(render)}`);
    bar.show(render);
    setText(error, errorText(render));
    picture.show(render);
  };
  return { node, show };
}

function samplesShort(render: Render): string {
  return `${formatSamples(render.progress.mean_samples)} / ${formatSamples(render.samples)} samples`;
}

function errorText(render: Render): string {
  return render.progress.relative_error > 0 ? `± ${formatRelativeError(render.progress.relative_error)}` : "";
}
