/** What happens to files that were dropped or chosen: a scene document is read, another renderer's scene imported. */
import { element } from "../dom.ts";
import { ServiceError } from "../service/client.ts";
import { imported, isOfOtherRenderer } from "./import_scene.ts";
import { readScene, type Scene } from "./scene_files.ts";

type Files = Map<string, Blob>;

interface Panel {
  say: (words: string) => void;
  failed: (error: unknown) => void;
  begin: (scene: Scene) => void;
  clear: () => void;
  report: HTMLElement;
  setFilm: (width: number, height: number) => void;
}

export function takes(panel: Panel): (files: Promise<Files>) => Promise<void> {
  return async (files) => {
    panel.clear();
    panel.say("Reading…");
    try {
      const all = await files;
      if (isOfOtherRenderer(all.keys())) {
        await bring(panel, all, false);
        return;
      }
      const scene = await readScene(all);
      panel.begin(scene);
      panel.say(scene.problems.length > 0 ? `${scene.path}: files are missing` : `${scene.path}, ${scene.files.size} files beside it`);
    } catch (error) {
      panel.failed(error);
    }
  };
}

/** Shows the parts that are not supported, and lets people go on without them. */
async function bring(panel: Panel, files: Files, allowMissing: boolean): Promise<void> {
  try {
    const scene = await imported(files, allowMissing, panel.say);
    panel.begin(scene);
    panel.setFilm(scene.film.width, scene.film.height);
    panel.say(`${scene.path} is imported`);
    panel.report.replaceChildren(element("ul", {}, ...scene.notes.map((note) => element("li", {}, note))));
  } catch (error) {
    panel.failed(error);
    if (!(error instanceof ServiceError) || error.problems.length === 0 || allowMissing) return;
    const button = element("button", { type: "button" }, "Import without these");
    button.addEventListener("click", () => {
      panel.clear();
      void bring(panel, files, true);
    });
    panel.report.replaceChildren(button);
  }
}
