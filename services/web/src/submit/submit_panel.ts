/** Submitting a scene: drop a folder or an archive, say what is wanted, send. */
import { announce, element, setText } from "../dom.ts";
import { renderRoute } from "../router.ts";
import { createRender, missingAssets, preflight, ServiceError, storeAsset } from "../service/client.ts";
import type { CreateRenderRequest, PreflightReport, Problem } from "../service/types.ts";
import { filesDropped, filesOf } from "./dropped.ts";
import { type Asked, submitForm } from "./form.ts";
import { preflightResult } from "./preflight_result.ts";
import { readScene, type Scene } from "./scene_files.ts";

/** Of a preflight where no stop is asked for. */
const usualError = 0.02;

export function submitPanel(): { node: HTMLElement; close: () => void } {
  const status = element("p", { role: "status" });
  const problems = problemList();
  const form = submitForm(
    (asked) => { if (scene) void send(scene, asked); },
    (asked) => { if (scene) void preflight(scene, asked); },
  );
  const report = element("div", {});
  const picker = pickers((files) => void take(files));
  const node = element("section", { class: "submit", "aria-labelledby": "submit-title" }, element("h2", { id: "submit-title" }, "Submit a scene"), picker, status, problems.node, form.node, report);
  let scene: Scene | undefined;
  form.node.hidden = true;

  const failed = (error: unknown): void => {
    setText(status, error instanceof Error ? error.message : String(error));
    problems.show(error instanceof ServiceError ? error.problems : []);
  };
  const take = async (files: Promise<Map<string, Blob>>): Promise<void> => {
    setText(status, "Reading…");
    problems.show([]);
    form.node.hidden = true;
    report.replaceChildren();
    try {
      scene = await readScene(await files);
      setText(status, scene.problems.length > 0 ? `${scene.path}: files are missing` : `${scene.path}, ${scene.files.size} files beside it`);
      problems.show(scene.problems);
      form.begin(typeof scene.document.name === "string" ? scene.document.name : (scene.path.split("/").at(-2) ?? "scene"));
      form.node.hidden = scene.problems.length > 0;
    } catch (error) {
      scene = undefined;
      failed(error);
    }
  };
  const working = async (work: () => Promise<void>): Promise<void> => {
    form.busy(true);
    problems.show([]);
    try {
      await work();
    } catch (error) {
      failed(error);
    }
    form.busy(false);
  };
  const send = (wanted: Scene, asked: Asked): Promise<void> => working(async () => {
    const request: CreateRenderRequest = { request_id: asked.requestId, scene: wanted.document, ...asked.request };
    await upload(wanted, status);
    setText(status, "Submitting…");
    const render = await createRender(request);
    announce(`${render.name} is submitted`);
    location.hash = renderRoute(render.id);
  });
  const preflight = (wanted: Scene, asked: Asked): Promise<void> => working(async () => {
    report.replaceChildren();
    const found = await preflightOf(wanted, asked, status);
    // Another scene may have been dropped meanwhile.
    if (scene === wanted) report.replaceChildren(...preflightResult(found, () => { scene = simpler(wanted, found, status); }));
  });
  return { node, close: takeDrops(node, (files) => void take(files)) };
}

async function preflightOf(wanted: Scene, { request }: Asked, status: HTMLElement): Promise<PreflightReport> {
  const { width, height, stop } = request;
  await upload(wanted, status);
  setText(status, "Rendering it small, with and without each part; this takes minutes…");
  const error = stop.relative_error ?? usualError;
  const found = await preflight({ scene: wanted.document, width, height, error });
  setText(status, `${wanted.path} is checked`);
  return found;
}

/** The scene that is enough; its files are there already. */
function simpler(scene: Scene, preflight: PreflightReport, status: HTMLElement): Scene {
  setText(status, `${scene.path}, simplified: ${preflight.chosen.without.join(", ")}`);
  return { ...scene, document: preflight.document };
}

async function upload({ files }: Scene, status: HTMLElement): Promise<void> {
  if (files.size === 0) return;
  const missing = await missingAssets([...files.keys()]);
  for (const [index, sha256] of missing.entries()) {
    setText(status, `Sending file ${index + 1} of ${missing.length}…`);
    const file = files.get(sha256);
    if (file) await storeAsset(sha256, file);
  }
}

function pickers(onFiles: (files: Promise<Map<string, Blob>>) => void): HTMLElement {
  const file = element("input", { type: "file", id: "scene-file", multiple: "", accept: ".zip,.json" });
  const folder = element("input", { type: "file", id: "scene-folder", webkitdirectory: "" });
  for (const input of [file, folder]) {
    input.addEventListener("change", () => {
      if (input.files?.length) onFiles(filesOf(input.files));
      input.value = "";
    });
  }
  return element(
    "div",
    { class: "drop" },
    element("p", {}, "Drop a scene's folder or ZIP anywhere on this page, or"),
    element("label", { class: "file", for: "scene-file" }, "choose a file", file),
    element("label", { class: "file", for: "scene-folder" }, "choose a folder", folder),
  );
}

/** Takes what is dropped on the page; returns what stops it. */
function takeDrops(node: HTMLElement, onFiles: (files: Promise<Map<string, Blob>>) => void): () => void {
  const over = (event: DragEvent): void => {
    event.preventDefault();
    node.classList.add("over");
  };
  const leave = (): void => { node.classList.remove("over"); };
  const drop = (event: DragEvent): void => {
    event.preventDefault();
    leave();
    if (event.dataTransfer) onFiles(filesDropped(event.dataTransfer));
    node.scrollIntoView({ block: "nearest" });
  };
  window.addEventListener("dragover", over);
  window.addEventListener("dragleave", leave);
  window.addEventListener("drop", drop);
  return () => {
    window.removeEventListener("dragover", over);
    window.removeEventListener("dragleave", leave);
    window.removeEventListener("drop", drop);
  };
}

function problemList(): { node: HTMLElement; show: (problems: readonly Problem[]) => void } {
  const node = element("ul", { class: "problems", role: "alert" });
  node.hidden = true;
  return {
    node,
    show: (problems) => {
      node.replaceChildren(...problems.map(({ place, message }) => element("li", {}, element("code", {}, place), ` ${message}`)));
      node.hidden = problems.length === 0;
    },
  };
}
