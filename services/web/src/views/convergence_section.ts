/** How the error falls: the history from the service, continued by live events. */
import { ConvergenceChart } from "../convergence/chart.ts";
import { type Abscissa, appended, toCurve } from "../convergence/points.ts";
import { element, setText } from "../dom.ts";
import { formatDuration, formatRelativeError } from "../format.ts";
import { getConvergence } from "../service/client.ts";
import { elapsedSeconds } from "../service/clock.ts";
import type { ErrorPoint, Render } from "../service/types.ts";

export interface ConvergenceSection {
  node: HTMLElement;
  /** Takes the history from the service; after a gap in the events, and at the end. */
  reload: () => void;
  /** Continues the curve. */
  show: (render: Render) => void;
  close: () => void;
}

export function convergenceSection(id: string): ConvergenceSection {
  const plot = element("div", { class: "plot" });
  const caption = element("figcaption", { class: "note" });
  const figure = element("figure", { "aria-label": "Relative error over time, both axes logarithmic" }, plot, caption);
  let points: readonly ErrorPoint[] = [];
  let abscissa: Abscissa = "time";
  const chart = new ConvergenceChart(plot);

  const draw = (): void => {
    const curve = toCurve(points, abscissa);
    chart.show(curve, abscissa);
    figure.dataset.points = `${curve.x.length}`;
    setText(caption, captionText(points));
  };
  const choice = abscissaChoice((chosen) => {
    abscissa = chosen;
    draw();
  });
  const reload = async (): Promise<void> => {
    try {
      points = await getConvergence(id);
      draw();
    } catch {
      // Live events still continue the curve; the next connection asks again.
    }
  };
  draw();

  return {
    node: element(
      "section",
      { "aria-labelledby": "convergence-title" },
      element("div", { class: "section-head" }, element("h2", { id: "convergence-title" }, "Convergence"), choice),
      figure,
    ),
    reload: () => void reload(),
    show: (render) => {
      const before = points;
      points = appended(points, pointOf(render));
      if (points !== before) draw();
    },
    close: () => {
      chart.close();
    },
  };
}

function pointOf(render: Render): ErrorPoint {
  const { photons, mean_samples, relative_error } = render.progress;
  return { time_s: elapsedSeconds(render), photons, samples: mean_samples, relative_error };
}

function captionText(points: readonly ErrorPoint[]): string {
  const last = points.at(-1);
  if (!last) return "No error estimate yet: it needs two samples in each pixel.";
  return `Relative error ${formatRelativeError(last.relative_error)} after ${formatDuration(last.time_s)}. Dashed: 1/√N, the fall of independent samples.`;
}

function abscissaChoice(onChoice: (abscissa: Abscissa) => void): HTMLElement {
  const option = (value: Abscissa, text: string): HTMLElement => {
    const input = element("input", { type: "radio", name: "abscissa", value });
    input.checked = value === "time";
    input.addEventListener("change", () => {
      onChoice(value);
    });
    return element("label", {}, input, text);
  };
  return element(
    "fieldset",
    { class: "choice" },
    element("legend", { class: "visually-hidden" }, "Horizontal axis"),
    option("time", "Time"),
    option("photons", "Photons"),
  );
}
