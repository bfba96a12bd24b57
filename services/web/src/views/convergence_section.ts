/** How the error falls: the history from the service, continued by live events. */
import { ConvergenceChart, type Line } from "../convergence/chart.ts";
import { type Abscissa, type Aim, appended, type Curve, toCurve } from "../convergence/points.ts";
import { element, setText } from "../dom.ts";
import { formatDuration, formatRelativeError } from "../format.ts";
import { getConvergence } from "../service/client.ts";
import { elapsedSeconds } from "../service/clock.ts";
import { axisInAddress, rememberAxis } from "../viewer/address.ts";
import { type ConvergencePoint, hasEnded, type Render } from "../service/types.ts";

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
  const warning = element("div", { class: "warning", role: "status" });
  const figure = element("figure", { "aria-label": "Relative error over time, both axes logarithmic" }, plot, caption);
  let render: Render | undefined;
  let points: readonly ConvergencePoint[] = [];
  let abscissa: Abscissa = axisInAddress();
  const chart = new ConvergenceChart(plot);

  const draw = (): void => {
    const curve = toCurve(points, abscissa, render && aimOf(render));
    chart.show({ x: curve.x, lines: linesOf(curve) }, abscissa);
    figure.dataset.points = `${curve.error.filter((error) => error !== null).length}`;
    setText(caption, captionText(points));
    showDoubt(warning, render?.progress.error_warning ?? "");
  };
  const choice = abscissaChoice(abscissa, (chosen) => {
    abscissa = chosen;
    rememberAxis(chosen);
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
      warning,
      figure,
    ),
    reload: () => void reload(),
    show: (now) => {
      const before = points;
      const ended = render !== undefined && hasEnded(render) !== hasEnded(now);
      render = now;
      points = appended(points, pointOf(now));
      if (points !== before || ended) draw();
    },
    close: () => {
      chart.close();
    },
  };
}

function pointOf(render: Render): ConvergencePoint {
  const { mean_samples, relative_error, top_percent_share, effective_pixels } = render.progress;
  return { time_s: elapsedSeconds(render), samples: mean_samples, relative_error, top_percent_share, effective_pixels };
}

function captionText(points: readonly ConvergencePoint[]): string {
  const last = points.at(-1);
  if (!last) return "No error estimate yet: it needs two samples in each pixel.";
  const share = last.top_percent_share > 0 ? ` The worst 1 % of the pixels have ${(100 * last.top_percent_share).toFixed(0)} % of the variance.` : "";
  return `Relative error ${formatRelativeError(last.relative_error)} after ${formatDuration(last.time_s)}.${share} Dashed: 1/√N, the fall of independent samples.`;
}

/** What is still to come; nothing once it has ended. */
function aimOf(render: Render): Aim | undefined {
  return hasEnded(render) ? undefined : { relativeError: render.stop.relative_error, samples: render.samples };
}

function linesOf(curve: Curve): Line[] {
  const lines: Line[] = [
    { label: "Relative error", values: curve.error, colour: "--accent", kind: "points" },
    { label: "1/√N", values: curve.guide, colour: "--muted", kind: "dashed" },
  ];
  if (curve.target.some((value) => value !== null)) lines.push({ label: "Target", values: curve.target, colour: "--succeeded", kind: "line" });
  if (curve.prediction.some((value) => value !== null)) {
    lines.push(
      { label: "Predicted", values: curve.prediction, colour: "--cancelled", kind: "line" },
      { label: "at most", values: curve.high, colour: "--accent", kind: "edge" },
      { label: "at least", values: curve.low, colour: "--accent", kind: "edge" },
    );
  }
  return lines;
}

function showDoubt(node: HTMLElement, sentence: string): void {
  node.hidden = sentence === "";
  if (node.dataset.text === sentence) return;
  node.dataset.text = sentence;
  node.replaceChildren(element("strong", {}, "The error is not to be trusted"), element("p", {}, sentence));
}

function abscissaChoice(chosen: Abscissa, onChoice: (abscissa: Abscissa) => void): HTMLElement {
  const option = (value: Abscissa, text: string): HTMLElement => {
    const input = element("input", { type: "radio", name: "abscissa", value });
    input.checked = value === chosen;
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
    option("samples", "Samples per pixel"),
  );
}
