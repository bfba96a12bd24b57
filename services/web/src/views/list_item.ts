/** One render in the list. */
import { element, setText } from "../dom.ts";
import { formatDuration, formatRelativeError, formatSamples } from "../format.ts";
import { groupRoute, renderRoute } from "../router.ts";
import { serviceNow } from "../service/clock.ts";
import { costOf } from "../service/price.ts";
import { hasEnded, type Render } from "../service/types.ts";
import { progressBar, stateBadge } from "./render_parts.ts";
import { thumbnail } from "./thumbnail.ts";

export interface ListItem {
  node: HTMLElement;
  show: (render: Render) => void;
  /** Chosen for what is done to several. */
  box: HTMLInputElement;
}

/** `onSelect`: it was selected, or is not any more. */
export function listItem(onSelect: () => void): ListItem {
  const box = element("input", { type: "checkbox" });
  box.addEventListener("change", onSelect);
  const node = element("li", {});
  const picture = thumbnail(node);
  const link = element("a", { class: "name" });
  const badge = stateBadge();
  const size = element("span");
  const group = element("a", { class: "in-group" });
  const tags = element("span", { class: "tags" });
  const bar = progressBar();
  const error = element("span", { class: "error", title: "Relative error, and its target" });
  const finish = element("span", { class: "finish" });
  const cost = element("span", { class: "cost", title: "Processor time of workers, so far and as predicted" });
  node.append(
    box,
    picture.node,
    element("div", { class: "what" }, element("h2", {}, link, badge.node), size, group, tags),
    element("div", { class: "how-far" }, bar.node, error, finish, cost),
  );

  let shown: Render | undefined;
  const show = (render: Render): void => {
    // The price may come later.
    setText(cost, costText(render));
    // Of hundreds most have ended, and stay as they are.
    if (render === shown && hasEnded(render)) return;
    shown = render;
    link.href = renderRoute(render.id);
    setText(link, render.name || render.id);
    box.setAttribute("aria-label", `Select ${render.name || render.id}`);
    badge.show(render.state);
    setText(size, `${render.width} × ${render.height} · ${samplesShort(render)}${render.owner ? ` · ${render.owner}` : ""}`);
    group.hidden = render.group === "";
    group.href = groupRoute(render.group);
    setText(group, `group ${render.group}`);
    setText(tags, render.tags.map((tag) => `#${tag}`).join("  "));
    tags.hidden = render.tags.length === 0;
    bar.show(render);
    setText(error, errorText(render));
    setText(finish, finishText(render));
    finish.title = render.target_unreachable;
    picture.show(render);
  };
  return { node, show, box };
}

function samplesShort(render: Render): string {
  return `${formatSamples(render.progress.mean_samples)} / ${formatSamples(render.samples)} samples`;
}

function errorText({ progress, stop }: Render): string {
  const target = stop.relative_error > 0 ? ` → ${formatRelativeError(stop.relative_error)}` : "";
  const warning = progress.error_warning ? " (not to be trusted)" : "";
  return progress.relative_error > 0 ? `error ${formatRelativeError(progress.relative_error)}${warning}${target}` : target;
}

function finishText(render: Render): string {
  if (hasEnded(render)) return render.started > 0 ? `took ${formatDuration(render.ended - render.started)}` : "";
  const end = render.progress.predicted_end;
  const miss = render.target_unreachable ? ", error out of reach" : "";
  return end > 0 ? `${formatDuration(Math.max(0, end - serviceNow()))} left${miss}` : "";
}

function costText({ progress, state }: Render): string {
  if (progress.cpu_seconds === 0) return "";
  const whole = progress.predicted_cpu_seconds > progress.cpu_seconds && state === "RUNNING" ? ` of ${formatDuration(progress.predicted_cpu_seconds)}` : "";
  const money = costOf(progress.cpu_seconds);
  return `CPU ${formatDuration(progress.cpu_seconds)}${whole}${money && ` · ${money}`}`;
}
