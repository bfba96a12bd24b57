/** A scene among files by path: its document, and what it refers to by relative paths. As nocturne_client/scene_files.py. */
import { sha256 } from "@noble/hashes/sha2.js";
import { bytesToHex } from "@noble/hashes/utils.js";
import { missingAssets, storeAsset } from "../service/client.ts";
import type { Problem, SceneDocument } from "../service/types.ts";

export interface Scene {
  document: SceneDocument;
  /** Of the document. */
  path: string;
  /** By SHA-256. */
  files: Map<string, Blob>;
  problems: Problem[];
}

const digestPrefix = "sha256:";
const mostDocumentBytes = 8 * 2 ** 20;

/** Where the scene document may be: the JSON files nearest to the top, or of these `scene.json` alone. */
export function documentPaths(paths: Iterable<string>): string[] {
  const depth = (path: string): number => path.split("/").length;
  const found = [...paths].filter((path) => path.toLowerCase().endsWith(".json"));
  const first = Math.min(...found.map(depth));
  const nearest = found.filter((path) => depth(path) === first).sort((a, b) => a.localeCompare(b));
  const named = nearest.filter((path) => path.slice(path.lastIndexOf("/") + 1) === "scene.json");
  return named.length > 0 ? named : nearest;
}

/** Of several JSON files the one that says it is a scene; throws Error where that is said by none, or by more. */
async function documentAmong(files: ReadonlyMap<string, Blob>): Promise<{ path: string; document: SceneDocument }> {
  const found: { path: string; document: SceneDocument }[] = [];
  let wrong: unknown = new Error("There is no scene document, a JSON file, among these files.");
  const paths = documentPaths(files.keys());
  for (const path of paths) {
    try {
      const blob = files.get(path);
      if (!blob || blob.size > mostDocumentBytes) throw new Error(`${path}: a scene document has at most 8 MiB; put meshes into files beside it.`);
      found.push({ path, document: parse(path, await blob.text()) });
    } catch (error) {
      wrong = error;
    }
  }
  const scenes = found.filter(({ document }) => "nocturne" in document);
  const [only, another] = scenes.length > 0 || found.length > 1 ? scenes : found;
  if (another) throw new Error(`There are several scene documents: ${scenes.map(({ path }) => path).join(", ")}. Take one of them, or call it scene.json.`);
  if (only) return only;
  throw found.length > 1 ? new Error(`None of ${paths.join(", ")} is a scene document: they have no "nocturne".`) : wrong;
}

/** Throws Error, fit to be shown, where there is no document; what it refers to and is not there becomes a problem. */
export async function readScene(files: ReadonlyMap<string, Blob>): Promise<Scene> {
  const { path, document } = await documentAmong(files);
  const scene: Scene = { document, path, files: new Map(), problems: [] };
  const folder = path.slice(0, path.lastIndexOf("/") + 1);
  for (const { place, part } of partsWithPaths(scene.document)) {
    const file = files.get(resolved(folder, part.asset));
    if (!file) {
      scene.problems.push({ place: `${place}.asset`, message: `${part.asset} is not among the files` });
      continue;
    }
    const sha256 = await digest(file);
    if (part.type === "mesh") part.format ??= part.asset.slice(part.asset.lastIndexOf(".") + 1).toLowerCase();
    part.asset = digestPrefix + sha256;
    scene.files.set(sha256, file);
  }
  return scene;
}

export function resolved(folder: string, asset: string): string {
  const parts = asset.split("/").filter((part) => part !== "." && part !== "");
  return asset.startsWith("/") || parts.includes("..") ? "" : folder + parts.join("/");
}

/** The service checks what it is. */
function parse(path: string, text: string): SceneDocument {
  let document: unknown;
  try {
    document = JSON.parse(text);
  } catch (error) {
    throw new Error(`${path}: not JSON: ${error instanceof Error ? error.message : ""}`, { cause: error });
  }
  if (typeof document !== "object" || document === null || Array.isArray(document)) throw new Error(`${path}: expected a JSON object`);
  return document as SceneDocument;
}

interface Part {
  asset: string;
  type?: unknown;
  format?: unknown;
}

/** Objects whose field "asset" is a path, with their places. In a sensor's responses people choose the keys. */
export function* partsWithPaths(value: unknown, place = "$"): Generator<{ place: string; part: Part }> {
  if (typeof value !== "object" || value === null) return;
  if (namesFile(value)) yield { place, part: value };
  for (const [key, inner] of Object.entries(value)) {
    if (key !== "responses") yield* partsWithPaths(inner, Array.isArray(value) ? `${place}[${key}]` : `${place}.${key}`);
  }
}

function namesFile(value: object): value is Part {
  return "asset" in value && typeof value.asset === "string" && !value.asset.startsWith(digestPrefix);
}

/** Sends those of the files, by SHA-256, that the service does not have. */
export async function upload(files: ReadonlyMap<string, Blob>, say: (words: string) => void): Promise<void> {
  if (files.size === 0) return;
  const missing = await missingAssets([...files.keys()]);
  for (const [index, sha256] of missing.entries()) {
    say(`Sending file ${index + 1} of ${missing.length}…`);
    const file = files.get(sha256);
    if (file) await storeAsset(sha256, file);
  }
}

export async function digest(file: Blob): Promise<string> {
  const hash = sha256.create();
  const reader = file.stream().getReader();
  for (let part = await reader.read(); !part.done; part = await reader.read()) hash.update(part.value);
  return bytesToHex(hash.digest());
}
