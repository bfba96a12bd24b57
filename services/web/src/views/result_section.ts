/** The light of a room, result first: a requirement's verdict, E_m and U0; the report as PDF and HTML. */
import { announce, element, scroller, setText, table, tableRow } from "../dom.ts";
import { derivedAddress } from "../service/client.ts";
import { getReportWords } from "../service/measuring.ts";
import { hasEnded, hasImage, type Render } from "../service/types.ts";
import { isOfRoom, leadOf, readingsOf, requirements, type Words } from "../measure/result.ts";

export class ResultSection {
  readonly node: HTMLElement;
  readonly #id: string;
  readonly #choice = element("select", {}, ...requirements.map(({ name, value }) => element("option", { value }, name)));
  readonly #limits = element("input", { type: "text", placeholder: "Em=500,U0=0.6,UGR=19", maxlength: "200" });
  readonly #byHand = element("label", { hidden: "" }, element("span", {}, "Limits"), this.#limits);
  readonly #judge = element("button", { type: "submit" }, "Show the result");
  readonly #verdict = element("p", { class: "verdict", role: "status" });
  readonly #problem = element("p", { class: "problem", role: "alert" });
  readonly #tables = element("div", {});
  readonly #pdf = element("a", {}, "Report as PDF");
  readonly #html = element("a", { target: "_blank", rel: "noopener" }, "Report as HTML");
  #asked = "?";
  constructor(id: string) {
    this.#id = id;
    this.#pdf.download = `nocturne-${id.slice(0, 12)}-report.pdf`;
    const form = element("form", { class: "year-form" }, element("label", {}, element("span", {}, "Requirement"), this.#choice), this.#byHand, this.#judge);
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      void this.#ask();
    });
    this.#choice.addEventListener("change", () => {
      this.#byHand.hidden = this.#choice.value !== "limits";
      this.#link();
    });
    this.#limits.addEventListener("input", () => { this.#link(); });
    const links = element("p", { class: "downloads" }, this.#pdf, this.#html);
    this.node = element("section", { class: "year-section result", "aria-labelledby": "result-title", hidden: "" }, element("h2", { id: "result-title" }, "Result"), this.#verdict, form, this.#problem, this.#tables, links);
    this.#link();
  }

  show(render: Render): void {
    this.node.hidden = !isOfRoom(render) || !hasImage(render);
    // A report takes seconds: of a render that goes on somebody has to ask for it.
    if (!this.node.hidden && hasEnded(render) && this.#asked === "?") void this.#ask();
  }

  #query(): string {
    const require = this.#choice.value === "limits" ? this.#limits.value.trim() : this.#choice.value;
    return new URLSearchParams(require ? { require } : {}).toString();
  }

  #link(): void {
    const query = this.#query();
    this.#pdf.href = `${derivedAddress(this.#id, "report.pdf")}?${query}`;
    this.#html.href = `${derivedAddress(this.#id, "report.html")}?${query}`;
  }

  async #ask(): Promise<void> {
    const query = this.#query();
    this.#asked = query;
    this.#judge.disabled = true;
    setText(this.#verdict, "The light is judged…");
    try {
      const found = await getReportWords(this.#id, query);
      if (this.#asked === query) this.#tell(found);
      setText(this.#problem, "");
    } catch (error) {
      setText(this.#verdict, "");
      setText(this.#problem, error instanceof Error ? error.message : String(error));
    } finally {
      this.#judge.disabled = false;
    }
  }

  #tell(found: Words): void {
    const { word, sentence } = leadOf(found);
    this.#verdict.replaceChildren(...(word ? [element("strong", { class: `verdict-${found.verdict}` }, word), " "] : []), sentence);
    if (sentence) announce(sentence);
    const checks = found.checks.map(({ what, limit, found: value, says }) => tableRow(what, [limit, value, says]));
    const tables = [
      ...(checks.length > 0 ? [table(["Required", "Limit", "Found, 95\u00a0%", "Verdict"], checks)] : []),
      ...readingsOf(found).map(({ title, head, rows }) => table(head.map((text, index) => (index === 0 ? text || "Part" : text)), rows.map(([name = "", ...cells]) => tableRow(name, cells)), `${title}; after ±: half of the 95 % interval`)),
    ];
    this.#tables.replaceChildren(
      ...found.warnings.map((warning) => element("p", { class: "problem" }, warning)),
      ...tables.map((each, index) => {
        const box = scroller("events", `Results ${index + 1}`);
        box.append(each);
        return box;
      }),
    );
  }
}
