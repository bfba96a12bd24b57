/** The figures of one render. */
import { element, setText } from "../dom.ts";
import { formatCount, formatDuration, formatRelativeError, formatSamples, formatValue, plusMinus, shownUnit } from "../format.ts";
import { costOf } from "../service/price.ts";
import { elapsedSeconds, serviceNow } from "../service/clock.ts";
import { hasEnded, type Render } from "../service/types.ts";

const errorMeaning =
  "How far a pixel typically is from its true value, from the scatter of its samples: the root mean square, over pixels, of the " +
  "standard error of Y over √(Y² + 0.01 M²), with M the image's mean Y. Halving it takes four times the samples.";

interface Fact {
  label: string;
  value: (render: Render) => string;
  meaning?: string;
}

const facts: Fact[] = [
  {
    label: "Relative error",
    value: (render) => formatRelativeError(render.progress.relative_error),
    meaning: errorMeaning,
  },
  {
    label: "Trust in it",
    value: ({ progress }) => (progress.relative_error <= 0 ? "–" : progress.error_warning || "yes, as far as one image can tell"),
  },
  { label: "Mean", value: meanText, meaning: "Of Y over all pixels, with its 95 % interval." },
  {
    label: "Nothing seen",
    value: ({ progress, width, height }) => `${formatCount(progress.zero_pixels)} of ${formatCount(width * height)} pixels`,
    meaning: "Pixels in which no sample has found light. They are not known to be black: light may reach them in few samples.",
  },
  {
    label: "Samples per pixel",
    value: (render) => `${formatSamples(render.progress.mean_samples)} of ${formatSamples(render.samples)}`,
  },
  { label: "Samples/s", value: (render) => rate(render, render.progress.samples_merged, render.progress.samples_per_second) },
  { label: "Rays/s", value: (render) => rate(render, render.progress.rays, render.progress.rays_per_second) },
  { label: "Rays", value: (render) => formatCount(render.progress.rays) },
  { label: "Elapsed", value: (render) => (render.started > 0 ? formatDuration(elapsedSeconds(render)) : "–") },
  {
    label: "Left",
    value: timeLeft,
    meaning: "From the rate and the error so far, to the first condition that ends the render.",
  },
  { label: "CPU time", value: ({ progress: { cpu_seconds } }) => [formatDuration(cpu_seconds), ...(cpu_seconds > 0 ? [`${formatValue(cpu_seconds / 3600, 3)} core\u00a0h`] : []), costOf(cpu_seconds)].filter(Boolean).join(" · ") },
  { label: "Invalid samples", value: (render) => formatCount(render.progress.invalid_samples), meaning: "Contributions that were NaN, infinite or negative; they are left out of the image." },
  { label: "Truncated paths", value: (render) => formatCount(render.progress.truncated_paths), meaning: "Photons ended by the tracer's limit of interactions; light that they would have brought is missing." },
  { label: "Tags", value: ({ tags }) => tags.join(", ") || "–", meaning: "Words to sort renders by; the list finds them." },
  { label: "Layers", value: ({ layers }) => layers.join(", ") || "–", meaning: "Extra channels of the EXR: properties of the surfaces in the image." },
  { label: "Engine", value: ({ engine }) => `${engine}`, meaning: "Version of the tracing engine: images of the same scene by different ones have different bits." },
  { label: "Wavelengths", value: ({ first_nm, last_nm }) => `${first_nm} to ${last_nm}\u00a0nm`, meaning: "Of the scene's light; others are in no number here." },
  { label: "Film", value: (render) => `${render.width} × ${render.height}` },
];

export function factsList(): { node: HTMLElement; show: (render: Render) => void } {
  const values = facts.map(() => element("dd"));
  const rows = facts.map((fact, index) => {
    const term = element("dt", {}, fact.label);
    if (fact.meaning) term.append(tooltip(fact.label, fact.meaning));
    return element("div", {}, term, values[index] ?? "");
  });
  return {
    node: element("dl", { class: "facts" }, ...rows),
    show: (render) => {
      values.forEach((value, index) => {
        setText(value, facts[index]?.value(render) ?? "");
      });
    },
  };
}

function meanText({ progress: { mean, mean_error }, unit }: Render): string {
  if (mean <= 0) return "–";
  const interval = mean_error > 0 ? `\u00a0${plusMinus(mean_error)}` : "";
  return `${formatValue(mean, 4)}${interval} ${shownUnit(unit)}`.trimEnd();
}

function timeLeft(render: Render): string {
  const end = render.progress.predicted_end;
  return hasEnded(render) || end <= 0 ? "–" : formatDuration(Math.max(0, end - serviceNow()));
}

/** While it runs the rate of now, afterwards the mean. */
function rate(render: Render, total: number, now: number): string {
  const elapsed = elapsedSeconds(render);
  const perSecond = hasEnded(render) && elapsed > 0 ? total / elapsed : now;
  return perSecond > 0 ? formatCount(perSecond) : "–";
}

/** A question mark whose text shows on hover and on focus, and goes with Escape. */
function tooltip(label: string, text: string): HTMLElement {
  const id = `about-${label.toLowerCase().replaceAll(/\W+/g, "-")}`;
  const button = element("button", { type: "button", "aria-label": `About ${label}`, "aria-describedby": id }, "?");
  button.addEventListener("keydown", (event) => {
    if (event.key === "Escape") button.blur();
  });
  return element("span", { class: "hint" }, button, element("span", { id, role: "tooltip" }, text));
}
