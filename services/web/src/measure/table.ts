/** Measured parts as a table: extremes, mean and uniformity with their standard errors. */
import { element, table, tableRow } from "../dom.ts";
import { formatValue, plusMinus, shownUnit } from "../format.ts";
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
  const headings = ["Part", "Min", "Mean", "Max", "U0", "Ud", ...(choices.onRemove ? [""] : [])];
  return table(headings, found.measurements.map((each, index) => row(each, index, choices)), `${quantityText(found)}; after ±: half of the 95 % interval`);
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
  const node = tableRow(element("label", {}, radio, nameOf(measured)), cells);
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
  return `${value === 0 ? "0" : formatValue(value, digits)}${!error ? "" : ` ${plusMinus(error)}`}`.replaceAll("e-", "e\u2212");
}
