/** What is wanted of a render: film, samples, when to stop, priority. */
import { element } from "../dom.ts";
import { wordsOf } from "../format.ts";
import type { CreateGroupRequest } from "../service/types.ts";
import type { Wanted } from "./members.ts";

export interface Asked {
  /** The same until something is changed: sending twice makes one render. */
  requestId: string;
  request: Required<Pick<CreateGroupRequest, "name" | "width" | "height" | "samples" | "stop" | "priority" | "layers">> & Pick<CreateGroupRequest, "group" | "after" | "tags">;
  /** How many renders of the scene, and what is other in them. */
  wanted: Wanted;
}

interface Field {
  name: string;
  label: string;
  value: string;
  /** Attributes of a number; none: a text. */
  number?: { min: string; max: string; step: string };
  hint?: string;
  /** Several lines. */
  lines?: true;
}

const fields: Field[] = [
  { name: "name", label: "Name", value: "" },
  { name: "width", label: "Width, pixels", value: "512", number: { min: "1", max: "16384", step: "1" } },
  { name: "height", label: "Height, pixels", value: "512", number: { min: "1", max: "16384", step: "1" } },
  { name: "samples", label: "Samples per pixel, at most", value: "1024", number: { min: "1", max: "1073741824", step: "1" } },
  { name: "error", label: "Stop at a relative error of, %", value: "", number: { min: "0.0001", max: "100", step: "any" } },
  { name: "minutes", label: "Stop after, minutes", value: "", number: { min: "0.01", max: "100000", step: "any" } },
  { name: "until", label: "Stop at", value: "", hint: "07:00" },
  { name: "priority", label: "Priority", value: "100", number: { min: "1", max: "1000", step: "1" } },
];

const moreFields: Field[] = [
  { name: "tile-error", label: "Each tile stops at a relative error of, %", value: "", number: { min: "0.0001", max: "100", step: "any" } },
  { name: "core-hours", label: "Stop after, core hours", value: "", number: { min: "0.0001", max: "1000000", step: "any" } },
  { name: "tags", label: "Tags, between commas", value: "" },
  { name: "bands", label: "Spectral bands, nm", value: "", hint: "380:780:10" },
  { name: "group", label: "Group", value: "" },
  { name: "after", label: "Begin when this group has ended", value: "" },
  { name: "frames", label: "Frames", value: "", hint: "1-240" },
  { name: "changes", label: "Changes of the scene, one a line", value: "", hint: "sensor.position[0]=-1..1", lines: true },
  { name: "varied", label: "Variants, one place a line", value: "", hint: "tracing.seed=1,2,3", lines: true },
];

const layers = ["albedo", "normal", "depth", "position", "object", "material", "emission"];
/** Channels of the sensor, both or none; layers are made by a pass of their own. */
const ofLight = ["direct", "indirect"];

/** `onPreflight` is for the second button, which asks what the scene needs. */
export function submitForm(onSubmit: (asked: Asked) => void, onPreflight: (asked: Asked) => void): { node: HTMLFormElement; begin: (name: string) => void; setFilm: (width: number, height: number) => void; busy: (busy: boolean) => void } {
  const inputs = new Map([...fields, ...moreFields].map((field) => [field.name, input(field)]));
  const button = element("button", { type: "submit", class: "primary" }, "Render");
  const preflight = element("button", { type: "button" }, "Preflight");
  const labelled = ({ name, label }: Field): HTMLElement => element("label", {}, element("span", {}, label), inputs.get(name) ?? "");
  const boxes = [...layers, ...ofLight].map((name) => element("input", { type: "checkbox", name: "layers", value: name }));
  const node = element("form", {}, ...fields.map(labelled), layersGroup(boxes), more(moreFields.map(labelled)), button, preflight);
  let requestId = newId();
  node.addEventListener("input", () => { requestId = newId(); });
  const ticked = (): string[] => boxes.filter(({ checked }) => checked).map(({ value }) => value);
  const value = (name: string): string => inputs.get(name)?.value ?? "";
  const wanted = (): Wanted => ({ frames: value("frames"), changes: value("changes"), varied: value("varied"), bands: value("bands"), parts: ticked().some((name) => ofLight.includes(name)) });
  const asked = (): Asked => ({ requestId, request: requestOf(value, ticked().filter((name) => layers.includes(name))), wanted: wanted() });
  node.addEventListener("submit", (event) => {
    event.preventDefault();
    onSubmit(asked());
  });
  preflight.addEventListener("click", () => { if (node.reportValidity()) onPreflight(asked()); });
  return {
    node,
    begin: (name) => {
      requestId = newId();
      const field = inputs.get("name");
      if (field) field.value = name;
    },
    setFilm: (width, height) => {
      for (const [name, edge] of [["width", width], ["height", height]] as const) {
        const field = inputs.get(name);
        if (field) field.value = String(edge);
      }
    },
    busy: (busy) => { button.disabled = preflight.disabled = busy; },
  };
}

/** From what stands in the fields. */
export function requestOf(value: (name: string) => string, layers: string[]): Asked["request"] {
  const stop: NonNullable<CreateGroupRequest["stop"]> = {};
  if (value("error")) stop.relative_error = Number(value("error")) / 100;
  if (value("minutes")) stop.wall_seconds = 60 * Number(value("minutes"));
  if (value("tile-error")) stop.tile_relative_error = Number(value("tile-error")) / 100;
  if (value("core-hours")) stop.cpu_seconds = 3600 * Number(value("core-hours"));
  if (value("until").trim()) stop.until = withZone(value("until").trim());
  const whole = (name: string): number => Math.round(Number(value(name)));
  const [group, after, tags] = [value("group").trim(), value("after").trim(), wordsOf(value("tags"))];
  return {
    name: value("name"), width: whole("width"), height: whole("height"), samples: whole("samples"), stop, priority: whole("priority"), layers,
    ...(group && { group }), ...(after && { after }), ...(tags.length > 0 && { tags }),
  };
}

/** A time of day without a zone is that of who types it. */
function withZone(time: string): string {
  return /^\d{1,2}:\d{2}$/.test(time) ? `${time} ${Intl.DateTimeFormat().resolvedOptions().timeZone}` : time;
}

function layersGroup(boxes: HTMLInputElement[]): HTMLElement {
  const choices = boxes.map((box) => element("label", { class: "choice" }, box, box.value));
  return element("fieldset", {}, element("legend", {}, "Layers of the EXR"), ...choices);
}

function more(labels: HTMLElement[]): HTMLElement {
  return element("details", { class: "more" }, element("summary", {}, "Frames, variants, groups, bands, tags, further stops"), element("div", { class: "grid" }, ...labels));
}

function input({ name, value, number, hint, lines }: Field): HTMLInputElement | HTMLTextAreaElement {
  if (lines) return element("textarea", { name, rows: "2", placeholder: hint, spellcheck: "false" });
  const kind = number ? { type: "number", required: value ? "" : undefined, ...number } : { type: "text", maxlength: "200" };
  return element("input", { name, value, placeholder: hint, ...kind });
}

/** Not randomUUID, which browsers keep from pages without TLS. */
function newId(): string {
  return [...crypto.getRandomValues(new Uint8Array(16))].map((byte) => byte.toString(16).padStart(2, "0")).join("");
}
