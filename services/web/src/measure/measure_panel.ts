/** "Measure": parts of the image with their numbers, a histogram or profile, isolines, and glare where it is known. */
import { announce, element, setText } from "../dom.ts";
import { Plot } from "../plot.ts";
import { getGlare, getIsolines, keepRegions, measure } from "../service/measuring.ts";
import { hasImage, type Measurements, type Outline, type Render } from "../service/types.ts";
import type { RenderImage } from "../viewer/render_image.ts";
import { chartOf } from "./charts.ts";
import { tellsOf } from "./colour_table.ts";
import { isolineControls, outlineForm } from "./forms.ts";
import { glareMarks } from "./glare_marks.ts";
import { glareText, hasGlare } from "./glare_text.ts";
import { isWhole } from "./outlines.ts";
import { quantityText, tableOf } from "./table.ts";

/** Milliseconds between measurements while tiles come. */
const pause_ms = 3000;
const bins = 48;

/** Asks the service only while it is open. */
export class MeasurePanel {
  readonly node: HTMLDetailsElement;
  readonly #id: string;
  readonly #image: RenderImage;
  readonly #form = outlineForm((outline) => this.#keep([...this.#kept, outline]));
  readonly #isolines = isolineControls(() => { this.#later(0); });
  readonly #problem = element("p", { class: "problem", role: "alert" });
  readonly #table = element("div", { class: "events" });
  readonly #told = element("div", { class: "events" });
  readonly #plot = element("div", { class: "plot" });
  readonly #chart = new Plot(this.#plot);
  readonly #csv: HTMLAnchorElement;
  readonly #profile: HTMLAnchorElement;
  readonly #glare = element("p", { class: "note" });
  #render: Render | undefined;
  #kept: readonly Outline[] = [];
  #chosen = 0;
  #timer = 0;
  /** Large images take seconds: one question at a time. */
  #isAsking = false;
  constructor(id: string, image: RenderImage) {
    this.#id = id;
    this.#image = image;
    const file = `nocturne-${id.slice(0, 12)}`;
    this.#csv = element("a", { download: `${file}.csv` }, "Table as CSV");
    this.#profile = element("a", { download: `${file}-profile.csv` }, "Profile as CSV");
    const links = element("p", { class: "downloads" }, this.#csv, this.#profile);
    const parts = [this.#form.node, this.#problem, this.#table, this.#told, this.#plot, links, this.#isolines.node, this.#glare];
    this.node = element("details", { class: "measure" }, element("summary", {}, "Measure"), ...parts);
    this.node.addEventListener("toggle", () => {
      if (!this.node.open) this.#hideMarks();
      this.#later(0);
    });
  }

  show(render: Render): void {
    const first = !this.#render || (!hasImage(this.#render) && hasImage(render));
    this.#render = render;
    this.node.hidden = !hasImage(render);
    if (first) this.#later(0);
  }

  /** What is drawn on the image; undefined: nothing any more. */
  draft(outline: Outline | undefined): void {
    this.#image.overlay.draft = outline;
    if (outline) this.#form.fill(outline);
    this.#image.viewer?.repaint();
  }

  #hideMarks(): void {
    this.#image.overlay.marks = [];
    this.#image.viewer?.repaint();
  }

  /** There are new samples. */
  refresh(): void {
    this.#later(pause_ms);
  }

  close(): void {
    window.clearTimeout(this.#timer);
    this.#chart.close();
  }

  /** What comes meanwhile does not put off what was asked for. */
  #later(delay_ms: number): void {
    if (this.#timer !== 0 && delay_ms > 0) return;
    window.clearTimeout(this.#timer);
    this.#timer = window.setTimeout(() => {
      this.#timer = 0;
      if (this.#isAsking) this.#later(pause_ms);
      else if (this.node.open && this.#render && hasImage(this.#render)) void this.#trying(this.#ask(this.#render));
    }, delay_ms);
  }

  async #ask(render: Render): Promise<void> {
    this.#isAsking = true;
    const found = await measure(this.#id, bins).finally(() => { this.#isAsking = false; });
    this.#kept = isWhole(found, render) ? [] : found.measurements.map(({ outline }) => outline);
    this.#showFound(found);
    const levels = this.#isolines.levels();
    this.#image.overlay.outlines = this.#kept;
    this.#image.overlay.isolines = levels && (await getIsolines(this.#id, levels));
    this.#image.viewer?.repaint();
    if (hasGlare(render)) {
      // Until every pixel has samples there is none.
      const told = await getGlare(this.#id).catch(() => undefined);
      setText(this.#glare, told ? glareText(told) : "");
      this.#image.overlay.marks = told && this.node.open ? glareMarks(told, render) : [];
      this.#image.viewer?.repaint();
    }
  }

  async #keep(outlines: readonly Outline[]): Promise<void> {
    await this.#trying(keepRegions(this.#id, outlines).then(({ regions }) => {
      this.#chosen = Math.max(0, regions.length - 1);
      this.#image.overlay.draft = undefined;
      announce(`${regions.length} ${regions.length === 1 ? "part is" : "parts are"} kept with the render`);
      this.#later(0);
    }));
  }

  #showFound(found: Measurements): void {
    this.#chosen = Math.min(this.#chosen, found.measurements.length - 1);
    this.#table.replaceChildren(tableOf(found, {
      chosen: this.#chosen,
      onChoose: (index) => {
        this.#chosen = index;
        this.#showFound(found);
        // Redrawing a table loses the focus of the pressed button in it.
        this.#table.querySelector<HTMLInputElement>("input:checked")?.focus();
      },
      onRemove: this.#kept.length > 0 ? (index) => void this.#keep(this.#kept.filter((_, other) => other !== index)) : undefined,
    }));
    const measured = found.measurements[this.#chosen];
    this.#told.replaceChildren(...(measured ? tellsOf(measured) : []));
    if (measured) this.#chart.show(chartOf({ measured, quantity: quantityText(found) }));
    linkTo(this.#csv, found.csv);
    linkTo(this.#profile, measured?.profile_csv ?? "");
    this.#profile.hidden = !measured?.profile_csv;
  }

  async #trying(act: Promise<void>): Promise<void> {
    try {
      await act;
      setText(this.#problem, "");
    } catch (error) {
      setText(this.#problem, error instanceof Error ? error.message : String(error));
    }
  }
}

function linkTo(link: HTMLAnchorElement, text: string): void {
  if (link.href) URL.revokeObjectURL(link.href);
  link.href = URL.createObjectURL(new Blob([text], { type: "text/csv" }));
}
