/** Measured parts as a table: extremes, mean and uniformity with their standard errors. */
import { element } from "../dom.ts";
import { formatValue, shownUnit } from "../format.ts";
import { capital } from "../image/look.ts";
import type { Measurement, Measurements } from "../service/types.ts";
import { kinds, pointsText } from "./outlines.ts";

export interface Choices {
  /** Which part has its chart drawn. */
  chosen: number;
  onChoose: (index: number) => void;
  /** Undefined where parts are not kept: the whole image. */
  onRemove: ((index: number) => void) | undefined;
}

/** What is measured, with its unit. */
export function quantityText({ quantity, unit }: Measurements): string {
  return `${capital(quantity)}${unit ? `, ${shownUnit(unit)}` : ""}`;
}

export function tableOf(found: Measurements, choices: Choices): HTMLElement {
  const caption = element("caption", {}, `${quantityText(found)}; after ±: one standard error`);
  const headings = ["Part", "Min", "Mean", "Max", "U0", "Ud", ...(choices.onRemove ? [""] : [])];
  const head = element("tr", {}, ...headings.map((text) => (text ? element("th", { scope: "col" }, text) : element("td"))));
  return element("table", {}, caption, element("thead", {}, head), element("tbody", {}, ...found.measurements.map((each, index) => row(each, index, choices))));
}

export function nameOf({ outline }: Measurement): string {
  return outline.name || `${kinds[outline.kind]} ${pointsText(outline.points)}`;
}

function row(measured: Measurement, index: number, { chosen, onChoose, onRemove }: Choices): HTMLElement {
  const radio = element("input", { type: "radio", name: "part" });
  radio.checked = index === chosen;
  radio.addEventListener("change", () => { onChoose(index); });
  const { minimum, maximum, mean, mean_error: meanError, u0, u0_error: u0Error, ud, ud_error: udError } = measured;
  const cells = [
    valueText(minimum.value, minimum.standard_error),
    valueText(mean, meanError),
    valueText(maximum.value, maximum.standard_error),
    valueText(u0, u0Error, 3),
    valueText(ud, udError, 3),
  ];
  const node = element("tr", {}, element("th", { scope: "row" }, element("label", {}, radio, nameOf(measured))), ...cells.map((text) => element("td", {}, text)));
  if (onRemove) {
    const remove = element("button", { type: "button", class: "quiet", "aria-label": `Remove ${nameOf(measured)}`, title: "Remove" }, "×");
    remove.addEventListener("click", () => { onRemove(index); });
    node.append(element("td", {}, remove));
  }
  return node;
}

function valueText(value: number | null, error: number | null, digits = 4): string {
  if (value === null) return "–";
  // Narrow tables break before the error, never within a number.
  return `${value === 0 ? "0" : formatValue(value, digits)}${!error ? "" : ` ±\u00a0${formatValue(error, 2)}`}`.replaceAll("e-", "e\u2212");
}
