/** A year of daylight: verdicts first, then a map of its hours, the plan of a chosen figure, and how many points have it. */
import { announce, element, scroller, setText, table, tableRow } from "../dom.ts";
import { derivedAddress, ServiceError } from "../service/client.ts";
import { getYear } from "../service/measuring.ts";
import { hasEnded, type Render } from "../service/types.ts";
import { figureNames, figureText, plansOf, shareText, valueOf, verdictText, type Year } from "../measure/year.ts";
import { histogramFigure, mapOfYear, planFigure } from "../measure/year_pictures.ts";

/** Milliseconds until a year that is not there yet is asked for again. */
const again_ms = 10_000;

interface Asked {
  lux: number;
  firstHour: number;
  lastHour: number;
}

export class YearSection {
  readonly node: HTMLElement;
  readonly #id: string;
  readonly #verdict = element("p", { class: "verdict", role: "status" });
  readonly #rest = element("ul", { class: "verdicts" });
  readonly #problem = element("p", { class: "problem", role: "alert" });
  readonly #wait = element("p", { class: "note" });
  readonly #body = element("div", { class: "year", hidden: "" });
  readonly #map = element("div", {});
  readonly #plans = element("div", { class: "plans" });
  readonly #means = element("div", {});
  readonly #figure = element("select", {});
  readonly #lux = numberField("300", "0.001", "any");
  readonly #first = numberField("8", "0", "0.5");
  readonly #last = numberField("18", "0", "0.5");
  readonly #file: HTMLAnchorElement;
  #year: Year | undefined;
  #asked = "";

  constructor(id: string) {
    this.#id = id;
    this.#file = element("a", { download: `nocturne-${id.slice(0, 12)}-year.json` }, "All figures as JSON");
    const count = element("button", { type: "submit" }, "Count again");
    const form = element(
      "form",
      { class: "year-form" },
      element("label", {}, element("span", {}, "Enough light, lx"), this.#lux),
      element("label", {}, element("span", {}, "From, o'clock"), this.#first),
      element("label", {}, element("span", {}, "To, o'clock"), this.#last),
      count,
    );
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      void this.#ask();
    });
    this.#figure.addEventListener("change", () => { this.#showPlans(); });
    const choice = element("label", { class: "figure-choice" }, element("span", {}, "Plan of"), this.#figure);
    this.#body.append(this.#map, choice, this.#plans, this.#means, element("p", {}, this.#file));
    this.node = element("section", { class: "year-section", "aria-labelledby": "year-title", hidden: "" }, element("h2", { id: "year-title" }, "A year of daylight"), this.#verdict, this.#rest, form, this.#problem, this.#wait, this.#body);
  }

  show(render: Render): void {
    this.node.hidden = render.sensor !== "daylight";
    if (this.node.hidden) return;
    if (!hasEnded(render)) setText(this.#wait, "The figures come when all renders of the group have ended.");
    else if (this.#asked === "") void this.#ask();
  }

  #question(): Asked {
    return { lux: this.#lux.valueAsNumber, firstHour: this.#first.valueAsNumber, lastHour: this.#last.valueAsNumber };
  }

  async #ask(): Promise<void> {
    const { lux, firstHour, lastHour } = this.#question();
    const query = new URLSearchParams({ lux: `${lux}`, first_hour: `${firstHour}`, last_hour: `${lastHour}` }).toString();
    this.#asked = query;
    setText(this.#wait, "The year is counted…");
    try {
      const year = await getYear(this.#id, query);
      if (this.#asked !== query) return;
      this.#year = year;
      setText(this.#problem, "");
      setText(this.#wait, "");
      this.#file.href = `${derivedAddress(this.#id, "annual.json")}?${query}`;
      this.#showYear(year, firstHour, lastHour);
    } catch (error) {
      setText(this.#wait, "");
      const isMissing = error instanceof ServiceError && error.status === 404;
      // Other renders of the group may still be at work.
      if (isMissing) window.setTimeout(() => { if (this.node.isConnected && this.#asked === query) void this.#ask(); }, again_ms);
      setText(isMissing ? this.#wait : this.#problem, error instanceof Error ? error.message : String(error));
    }
  }

  #showYear(year: Year, first: number, last: number): void {
    const [acceptable, ...others] = year.verdicts;
    const lead = `${shareText("sDA", year.sDA)}${acceptable ? `, ${verdictText(acceptable)}` : ""}`;
    setText(this.#verdict, lead);
    announce(lead);
    this.#rest.replaceChildren(
      element("li", {}, shareText("ASE", year.ASE)),
      ...others.map((each) => element("li", {}, verdictText(each))),
      ...(year["blinds closed"] === undefined ? [] : [element("li", {}, `Blinds are closed in ${(100 * year["blinds closed"]).toFixed(1)}\u00a0% of the hours`)]),
    );
    this.#map.replaceChildren(mapOfYear(year.hourly, first, last));
    const chosen = this.#figure.value;
    this.#figure.replaceChildren(...figureNames(year).map((name) => element("option", { value: name }, name)));
    this.#figure.value = figureNames(year).includes(chosen) ? chosen : "DA";
    this.#showPlans();
    const rows = Object.entries(year.means).map(([name, figure]) => tableRow(name, [figureText(name, figure)]));
    const told = `Means of the points, ${year.weather}: ${year.hours} hours, ${year.samples} samples of each; after ±: half of the 95 % interval`;
    const means = scroller("events", "Means of the points");
    means.append(table(["Figure", "Mean"], rows, told));
    this.#means.replaceChildren(means);
    this.#body.hidden = false;
  }

  #showPlans(): void {
    const year = this.#year;
    if (!year) return;
    const name = this.#figure.value;
    const plans = plansOf(year);
    const values = plans.flatMap(({ points }) => points.map((point) => valueOf(point, name)));
    const range = { low: Math.min(...values), high: Math.max(...values) };
    this.#plans.replaceChildren(...plans.map((plan) => planFigure(plan, name, range)), histogramFigure(values, name));
  }
}

function numberField(value: string, least: string, step: string): HTMLInputElement {
  return element("input", { type: "number", value, min: least, step, required: "" });
}
