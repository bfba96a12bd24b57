/** What is wanted of a render: film, samples, when to stop, priority. */
import { element } from "../dom.ts";
import type { CreateRenderRequest } from "../service/types.ts";

export interface Asked {
  /** The same until something is changed: sending twice makes one render. */
  requestId: string;
  request: Required<Pick<CreateRenderRequest, "name" | "width" | "height" | "samples" | "stop" | "priority" | "layers">>;
}

interface Field {
  name: string;
  label: string;
  value: string;
  /** Attributes of a number; none: a text. */
  number?: { min: string; max: string; step: string };
  hint?: string;
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

const layers = ["albedo", "normal", "depth", "position", "object", "material"];

/** `onPreflight` is for the second button, which asks what the scene needs. */
export function submitForm(onSubmit: (asked: Asked) => void, onPreflight: (asked: Asked) => void): { node: HTMLFormElement; begin: (name: string) => void; setFilm: (width: number, height: number) => void; busy: (busy: boolean) => void } {
  const inputs = new Map(fields.map((field) => [field.name, input(field)]));
  const button = element("button", { type: "submit", class: "primary" }, "Render");
  const preflight = element("button", { type: "button" }, "Preflight");
  const labels = fields.map(({ name, label }) => element("label", {}, element("span", {}, label), inputs.get(name) ?? ""));
  const boxes = layers.map((name) => element("input", { type: "checkbox", name: "layers", value: name }));
  const node = element("form", {}, ...labels, layersGroup(boxes), button, preflight);
  let requestId = newId();
  node.addEventListener("input", () => { requestId = newId(); });
  const wanted = (): string[] => boxes.filter(({ checked }) => checked).map(({ value }) => value);
  const asked = (): Asked => ({ requestId, request: requestOf((name) => inputs.get(name)?.value ?? "", wanted()) });
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
  const stop: NonNullable<CreateRenderRequest["stop"]> = {};
  if (value("error")) stop.relative_error = Number(value("error")) / 100;
  if (value("minutes")) stop.wall_seconds = 60 * Number(value("minutes"));
  if (value("until").trim()) stop.until = withZone(value("until").trim());
  const whole = (name: string): number => Math.round(Number(value(name)));
  return { name: value("name"), width: whole("width"), height: whole("height"), samples: whole("samples"), stop, priority: whole("priority"), layers };
}

/** A time of day without a zone is that of who types it. */
function withZone(time: string): string {
  return /^\d{1,2}:\d{2}$/.test(time) ? `${time} ${Intl.DateTimeFormat().resolvedOptions().timeZone}` : time;
}

function layersGroup(boxes: HTMLInputElement[]): HTMLElement {
  const choices = boxes.map((box) => element("label", { class: "choice" }, box, box.value));
  return element("fieldset", {}, element("legend", {}, "Layers of the EXR"), ...choices);
}

function input({ name, value, number, hint }: Field): HTMLInputElement {
  const kind = number ? { type: "number", required: value ? "" : undefined, ...number } : { type: "text", maxlength: "200" };
  return element("input", { name, value, placeholder: hint, ...kind });
}

/** Not randomUUID, which browsers keep from pages without TLS. */
function newId(): string {
  return [...crypto.getRandomValues(new Uint8Array(16))].map((byte) => byte.toString(16).padStart(2, "0")).join("");
}
