/** A scene of another renderer among files by path: the service makes a scene document of it. */
import { importScene } from "../service/client.ts";
import type { ImportedScene, Problem } from "../service/types.ts";
import { digest, type Scene, upload } from "./scene_files.ts";

const ends = [".xml", ".pbrt", ".pbrt.gz", ".gltf", ".glb", ".rad"];

export interface Imported extends Scene {
  film: { width: number; height: number };
  notes: string[];
}

/** Whether there is something to be imported, and no scene.json; other JSON lies beside many models. */
export function isOfOtherRenderer(paths: Iterable<string>): boolean {
  const all = [...paths];
  return all.some((path) => ends.some((end) => path.toLowerCase().endsWith(end))) && !all.some((path) => path.endsWith("scene.json"));
}

/** Sends the files and asks for the document; `say` shows how far it is. Throws ServiceError. */
export async function imported(files: ReadonlyMap<string, Blob>, allowMissing: boolean, say: (words: string) => void): Promise<Imported> {
  const digests = new Map<string, string>();
  for (const [path, file] of files) digests.set(path, await digest(file));
  await upload(new Map([...files].map(([path, file]) => [digests.get(path) ?? "", file])), say);
  say("Importing…");
  return sceneOf(await importScene({ files: Object.fromEntries(digests), allow_missing: allowMissing }));
}

/** Its files are at the service already. */
export function sceneOf(found: ImportedScene): Imported {
  const { document, scene, width, height, notes, missing } = found;
  return { document, path: scene, files: new Map(), problems: [], film: { width, height }, notes: [...missing.map(words), ...notes] };
}

const words = ({ place, message }: Problem): string => `Left out: ${place}: ${message}`;
