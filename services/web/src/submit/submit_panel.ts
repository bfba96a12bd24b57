/** Submitting a scene: drop a folder or an archive, say what is wanted, send. */
import { announce, element } from "../dom.ts";
import { formatDuration } from "../format.ts";
import { groupRoute, renderRoute } from "../router.ts";
import { createGroup, preflight } from "../service/client.ts";
import type { CreateGroupRequest, PreflightReport, SceneDocument } from "../service/types.ts";
import { filesDropped, filesOf } from "./dropped.ts";
import { type Asked, submitForm } from "./form.ts";
import { membersOf } from "./members.ts";
import { messages } from "./messages.ts";
import { preflightResult } from "./preflight_result.ts";
import { type Scene, upload } from "./scene_files.ts";
import { takes } from "./taking.ts";

type Say = (words: string) => void;

/** Of a preflight where no stop is asked for. */
const usualError = 0.02;

export function submitPanel(): { node: HTMLElement; close: () => void } {
  const { status, problems, say, failed, show, correctable, corrected } = messages();
  const form = submitForm(
    (asked) => { if (scene) void send(scene, asked); },
    (asked) => { if (scene) void preflight(scene, asked); },
  );
  const report = element("div", {});
  const picker = pickers((files) => void take(files));
  const title = element("h2", { id: "submit-title" }, "Submit a scene");
  const node = element("section", { class: "submit", "aria-labelledby": "submit-title" }, title, picker, status, problems, form.node, report);
  let scene: Scene | undefined;
  form.node.hidden = true;
  form.node.addEventListener("input", corrected);

  const begin = (taken: Scene): void => {
    scene = taken;
    show(taken.problems);
    form.begin(typeof taken.document.name === "string" ? taken.document.name : (taken.path.split("/").at(-2) ?? "scene"));
    form.node.hidden = taken.problems.length > 0;
  };
  const clear = (): void => {
    scene = undefined;
    show([]);
    form.node.hidden = true;
    report.replaceChildren();
  };
  const take = takes({ say, failed, begin, clear, report, setFilm: form.setFilm });
  const working = async (work: () => Promise<void>): Promise<void> => {
    form.busy(true);
    await correctable(work);
    form.busy(false);
  };
  const send = (wanted: Scene, asked: Asked): Promise<void> => working(async () => {
    const request = requestOf(wanted.document, asked);
    await upload(wanted.files, say);
    say("Submitting…");
    const { name, renders } = await createGroup(request);
    const [only] = renders;
    announce(renders.length === 1 ? `${only?.name} is submitted` : `${renders.length} renders are submitted`);
    location.hash = renders.length === 1 && only ? renderRoute(only.id) : groupRoute(name);
  });
  const preflight = (wanted: Scene, asked: Asked): Promise<void> => working(async () => {
    report.replaceChildren();
    const found = await preflightOf(wanted, asked, say);
    // Another scene may have been dropped meanwhile.
    if (scene === wanted) report.replaceChildren(...preflightResult(found, () => { scene = simpler(wanted, found, say); }));
  });
  return { node, close: takeDrops(node, (files) => void take(files)) };
}

/** Asked again, it gives the same renders. */
export function requestOf(document: SceneDocument, { requestId, request, wanted }: Asked): CreateGroupRequest {
  return { ...request, request_id: requestId, scene: document, ...membersOf(wanted) };
}

async function preflightOf(wanted: Scene, { request }: Asked, say: Say): Promise<PreflightReport> {
  const { width, height, stop } = request;
  await upload(wanted.files, say);
  const start = performance.now();
  const tell = (): void => {
    const elapsed = formatDuration(Math.round((performance.now() - start) / 1000));
    say(`Rendering it small, with and without each part; this takes minutes… ${elapsed}`);
  };
  tell();
  const timer = setInterval(tell, 5000);
  try {
    const found = await preflight({ scene: wanted.document, width, height, error: stop.relative_error ?? usualError });
    say(`${wanted.path} is checked`);
    return found;
  } finally {
    clearInterval(timer);
  }
}

/** The scene that is enough; its files are there already. */
function simpler(scene: Scene, preflight: PreflightReport, say: Say): Scene {
  say(`${scene.path}, simplified: ${preflight.chosen.without.join(", ")}`);
  return { ...scene, document: preflight.document };
}

function pickers(onFiles: (files: Promise<Map<string, Blob>>) => void): HTMLElement {
  const file = element("input", { type: "file", id: "scene-file", multiple: "", accept: ".zip,.json,.xml,.pbrt,.gltf,.glb" });
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
    element("p", {}, "Drop a scene's folder or ZIP anywhere on this page (also of Mitsuba 3, pbrt-v4 or glTF), or"),
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
