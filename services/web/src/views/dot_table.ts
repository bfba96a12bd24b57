/** A table whose middle column shows numbers as dots on one logarithmic axis: readable as a chart and as text. */
import { element } from "../dom.ts";

export interface DotRow {
  name: string;
  /** The one that counts; undefined: not known. */
  value: number | undefined;
  others: readonly number[];
}

export interface DotTable {
  caption: string;
  columns: readonly [string, string, string];
  rows: readonly DotRow[];
  /** A value with a line through all rows. */
  line?: number;
  format: (value: number) => string;
}

export function dotTable({ caption, columns, rows, line, format }: DotTable): HTMLElement {
  const all = rows.flatMap(({ value, others }) => [...others, ...(value === undefined ? [] : [value])]).concat(line ?? []);
  const [low, high] = [Math.floor(Math.log10(Math.min(...all))), Math.ceil(Math.log10(Math.max(...all)))];
  const place = (value: number): string => `${(100 * (Math.log10(value) - low)) / Math.max(1, high - low)}%`;
  const mark = (name: string, value: number): HTMLElement => {
    const node = element("i", { class: name, title: format(value) });
    node.style.left = place(value);
    return node;
  };
  const ticks = Array.from({ length: high - low + 1 }, (_, index) => 10 ** (low + index)).filter((_, index) => high - low <= 5 || index % 2 === 0);
  const labels = ticks.map((value) => {
    const node = element("span", {}, value.toLocaleString("en", { maximumSignificantDigits: 1 }));
    node.style.left = place(value);
    return node;
  });
  const body = rows.map(({ name, value, others }) => {
    const dots = element("div", { class: "track", "aria-hidden": "true" }, ...(line === undefined ? [] : [mark("line", line)]), ...others.map((each) => mark("other", each)), ...(value === undefined ? [] : [mark("own", value)]));
    return element("tr", {}, element("th", { scope: "row" }, name), element("td", { class: "dots" }, dots), element("td", {}, value === undefined ? "–" : format(value)));
  });
  const head = columns.map((text) => element("th", { scope: "col" }, text));
  const axis = element("tr", { class: "axis", "aria-hidden": "true" }, element("td"), element("td", { class: "dots" }, element("div", { class: "track" }, ...labels)), element("td"));
  return element("table", { class: "dot-table" }, element("caption", {}, caption), element("thead", {}, element("tr", {}, ...head)), element("tbody", {}, ...body, axis));
}
