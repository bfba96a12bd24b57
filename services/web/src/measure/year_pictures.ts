/** A year of daylight as pictures: the map of its hours, plans, and how many points have a value. */
import { element, scroller, table, tableRow } from "../dom.ts";
import { formatValue } from "../format.ts";
import { mapBytes, maps, mapSize } from "../image/colour_maps.ts";
import { daysIn, histogramOf, monthlyMeans, months, monthStarts, type Plan, shortText, stepOf, steps, unitOf, valueOf } from "./year.ts";

const svgNamespace = "http://www.w3.org/2000/svg";
const bins = 12;
/** Pixels of the map for a day and an hour. */
const cell = { width: 2, height: 8 };
const hoursOfDay = 24;

function colourAt(part: number): string {
  const bytes = mapBytes(maps.viridis);
  const at = 4 * Math.min(mapSize - 1, Math.max(0, Math.floor(part * (mapSize - 1))));
  return `rgb(${bytes[at] ?? 0} ${bytes[at + 1] ?? 0} ${bytes[at + 2] ?? 0})`;
}

/** Colours of the steps of illuminance, from below the first on. */
const stepColours = Array.from({ length: steps.length + 1 }, (_, index) => colourAt(index / steps.length));

/** Days to the right, hours upwards; and the months' means as a table. */
export function mapOfYear(hourly: readonly number[], first: number, last: number): HTMLElement {
  const days = daysIn(hourly);
  const canvas = element("canvas", { class: "year-map", role: "img", "aria-label": "Mean illuminance of the points by day of the year and hour of the day; the table of months has it in numbers" });
  canvas.width = days * cell.width;
  canvas.height = hoursOfDay * cell.height;
  const context = canvas.getContext("2d");
  if (context) {
    for (let day = 0; day < days; day += 1) {
      for (let hour = 0; hour < hoursOfDay; hour += 1) {
        const value = hourly[day * hoursOfDay + hour] ?? 0;
        context.fillStyle = value > 0 ? (stepColours[stepOf(value)] ?? "") : "#101014";
        context.fillRect(day * cell.width, (hoursOfDay - 1 - hour) * cell.height, cell.width, cell.height);
      }
    }
  }
  const letters = monthStarts(days).map((start, month) => {
    const label = element("span", {}, (months[month] ?? "").charAt(0));
    label.style.left = `${(100 * start) / days}%`;
    return label;
  });
  const legend = element("div", { class: "year-legend" }, ...steps.map((step, index) => {
    const swatch = element("i", { "aria-hidden": "true" });
    swatch.style.background = stepColours[index + 1] ?? "";
    return element("span", {}, swatch, `${step}`);
  }), "lx and more");
  const means = monthlyMeans(hourly, first, last).map((value, month) => tableRow(months[month] ?? "", [`${formatValue(value, 3)}\u00a0lx`]));
  const numbers = scroller("events", "Months");
  numbers.append(table(["Month", "Mean"], means, `Mean illuminance of the points from ${first} to ${last} o'clock`));
  const hours = element("div", { class: "year-hours", "aria-hidden": "true" }, ...[24, 18, 12, 6, 0].map((hour) => element("span", {}, `${hour}`)));
  const frame = element("div", { class: "year-frame" }, hours, element("div", {}, canvas, element("div", { class: "year-months", "aria-hidden": "true" }, ...letters)));
  const caption = element("figcaption", {}, "Mean illuminance of the points by day and hour of standard time");
  return element("figure", {}, caption, frame, legend, element("details", {}, element("summary", {}, "Months in numbers"), numbers));
}

function svg(name: string, attributes: Record<string, string | number>, ...children: (Node | string)[]): SVGElement {
  const node = document.createElementNS(svgNamespace, name);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, `${value}`);
  node.append(...children);
  return node;
}

/** A square for each point, in its colour and with its number. */
export function planFigure({ instrument, columns, points }: Plan, name: string, { low, high }: { low: number; high: number }): HTMLElement {
  const size = 40;
  const rows = Math.ceil(points.length / columns);
  const squares = points.map((point, index) => {
    const value = valueOf(point, name);
    const part = high > low ? (value - low) / (high - low) : 0.5;
    const [x, y] = [(index % columns) * size, Math.floor(index / columns) * size];
    const text = svg("text", { x: x + size / 2, y: y + size / 2 + 4, "text-anchor": "middle", "font-size": 12, fill: part > 0.6 ? "#000" : "#fff" }, shortText(name, value));
    return svg("g", {}, svg("rect", { x, y, width: size, height: size, fill: colourAt(part) }), text);
  });
  const told = points.map((point) => shortText(name, valueOf(point, name))).join(", ");
  const picture = svg("svg", { viewBox: `0 0 ${columns * size} ${rows * size}`, role: "img", "aria-label": `${name} at the points of ${instrument}, ${unitOf(name)}, row by row: ${told}` }, ...squares);
  picture.style.maxWidth = `${columns * size}px`;
  return element("figure", { class: "plan" }, element("figcaption", {}, `${instrument}: ${name}, ${unitOf(name)}`), picture);
}

export function histogramFigure(values: readonly number[], name: string): HTMLElement {
  const { edges, counts } = histogramOf(values, bins);
  const most = Math.max(...counts, 1);
  const [width, height] = [30, 120];
  const bars = counts.map((count, index) => svg("rect", { x: index * width + 1, y: height - (height * count) / most, width: width - 2, height: (height * count) / most, class: "year-bar" }));
  const labels = [0, bins / 2, bins].map((index) => svg("text", { x: index * width, y: height + 16, "font-size": 12, "text-anchor": index === 0 ? "start" : index === bins ? "end" : "middle", class: "year-tick" }, shortText(name, edges[index] ?? 0)));
  const told = counts.map((count, index) => `${count} from ${shortText(name, edges[index] ?? 0)}`).join(", ");
  const picture = svg("svg", { viewBox: `0 0 ${bins * width} ${height + 20}`, role: "img", "aria-label": `Points by ${name}, ${unitOf(name)}: ${told}` }, ...bars, ...labels);
  picture.style.maxWidth = `${bins * width}px`;
  return element("figure", { class: "plan" }, element("figcaption", {}, `Number of points by ${name}, ${unitOf(name)}`), picture);
}
