/** The REST calls that the page makes. Every failure is an Error whose message can be shown. */
import { observeDate } from "./clock.ts";
import { type TiledImage, tiledImageOf } from "../image/tiled_image.ts";
import { decodeTiles } from "../image/tiles.ts";
import type { operations } from "./openapi.d.ts";
import type {
  Answer,
  Group,
  ConvergencePoint,
  CreateGroupRequest,
  ImportedScene,
  ImportRequest,
  LearnedLight,
  NewGroup,
  PreflightReport,
  PreflightRequest,
  Problem,
  ProblemDetails,
  Region,
  RegionReading,
  Render,
  RenderPage,
  Session,
  TileInProgress,
  Usage,
  Worker,
  WorkerHistory,
  WorkOfWorker,
} from "./types.ts";

export class ServiceError extends Error {
  readonly status: number;
  /** What is wrong where; empty where the service names no places. */
  readonly problems: readonly Problem[];

  constructor(status: number, message: string, problems: readonly Problem[] = []) {
    super(message);
    this.status = status;
    this.problems = problems;
  }
}

export const previewAddress = (id: string, sequence?: number): string =>
  `${renderAddress(id)}/preview.png${sequence === undefined ? "" : `?v=${sequence}`}`;
export const thumbnailAddress = (id: string, sequence: number): string => `${renderAddress(id)}/thumbnail.png?v=${sequence}`;
export const tilesAddress = (id: string): string => `${renderAddress(id)}/tiles`;
export const sceneAddress = (id: string): string => `${renderAddress(id)}/scene.json`;
/** Of its image, and of what the service makes of that when somebody asks. */
export const derivedAddress = (id: string, name: string): string => `${renderAddress(id)}/${name}`;

/** `release` gives a worker in quarantine, or a drained one, jobs again; `drain` lets it finish what it has. */
export async function changeWorker(id: string, act: "drain" | "release"): Promise<void> {
  const response = await fetch(`/v1/workers/${encodeURIComponent(id)}:${act}`, { method: "POST" });
  if (!response.ok) throw await failureOf(response);
}

/** Who uses what, and what it costs. */
export async function getUsage(): Promise<Usage> {
  return getJson<"get_usage">("/v1/usage");
}

export async function getGroup(name: string): Promise<Group> {
  return getJson<"get_group">(`/v1/groups/${encodeURIComponent(name)}`);
}

/** `group`: of this one only, up to 200 at once. `search`: with all these words. */
export async function listRenders(pageToken = "", group = "", search = ""): Promise<RenderPage> {
  const query = new URLSearchParams({ page_size: group ? "200" : "50", group, search });
  if (pageToken) query.set("page_token", pageToken);
  return getJson<"list_renders">(`/v1/renders?${query.toString()}`);
}

export async function getRender(id: string): Promise<Render> {
  return getJson<"get_render">(renderAddress(id));
}

export async function cancelRender(id: string): Promise<Render> {
  return getJson<"cancel_render">(`${renderAddress(id)}:cancel`, { method: "POST" });
}

/** Which renders each worker is tracing, and since when. */
export async function listWork(): Promise<WorkOfWorker[]> {
  return (await getJson<"get_work">("/v1/workers/work")).work;
}

/** Of a render that has ended; with its images. */
export async function deleteRender(id: string): Promise<void> {
  const response = await fetch(renderAddress(id), { method: "DELETE" });
  if (!response.ok) throw await failureOf(response);
}

/** A region of the film that gets its samples first; undefined: all parts are alike. */
export async function lookFirst(id: string, region: Region | undefined): Promise<Render> {
  return getJson<"look_first">(`${renderAddress(id)}:lookFirst`, { method: "POST", body: JSON.stringify(region ?? {}) });
}

/** Renders of the same scene and film by other engines. */
export async function getBaselines(id: string): Promise<Render[]> {
  return (await getJson<"get_baselines">(`${renderAddress(id)}/baselines`)).renders;
}

export async function getExplanation(id: string): Promise<string> {
  return (await getJson<"explain_render">(`${renderAddress(id)}/explanation`)).sentence;
}

/** What a region of the image shows, with the errors of all quantities. */
export async function readRegion(id: string, { x, y, width, height }: Region): Promise<RegionReading> {
  const query = new URLSearchParams(Object.entries({ x, y, width, height }).map(([name, value]) => [name, `${value}`]));
  return getJson<"read_region">(`${renderAddress(id)}/reading?${query.toString()}`);
}

/** Of a render whose photons are guided, at what a pixel shows; takes a second or more, as the scene is read. */
export async function getLearnedLight(id: string, x: number, y: number): Promise<LearnedLight> {
  return getJson<"get_learned_light">(`${renderAddress(id)}/learned-light?x=${x}&y=${y}`);
}

export async function getTilesInProgress(id: string): Promise<TileInProgress[]> {
  return (await getJson<"get_tiles_in_progress">(`${renderAddress(id)}/tiles-in-progress`)).tiles;
}

export async function getWorkerHistory(): Promise<WorkerHistory> {
  return getJson<"get_worker_history">("/v1/workers/history");
}

/** Which of these files the service does not have yet. */
export async function missingAssets(digests: string[]): Promise<string[]> {
  return (await getJson<"missing_assets">("/v1/assets:batchMissing", { method: "POST", body: JSON.stringify({ sha256: digests }) })).sha256;
}

export async function storeAsset(sha256: string, content: Blob): Promise<void> {
  await getJson<"store_asset">(`/v1/assets/${sha256}`, { method: "PUT", body: content });
}

export async function createGroup(request: CreateGroupRequest): Promise<NewGroup> {
  return getJson<"create_group">("/v1/groups", { method: "POST", body: JSON.stringify(request) });
}

/** What a scene needs for a relative error; takes minutes. */
export async function preflight(request: PreflightRequest): Promise<PreflightReport> {
  return getJson<"preflight">("/v1/preflights", { method: "POST", body: JSON.stringify(request) });
}

/** The document of another renderer's scene, whose files are uploaded; takes up to minutes. */
export async function importScene(request: ImportRequest): Promise<ImportedScene> {
  return getJson<"import_scene">("/v1/imports", { method: "POST", body: JSON.stringify(request) });
}

/** An OpenEXR file from disk as a film, in tiles of this edge; the service reads all that OpenImageIO can. */
export async function readPicture(file: Blob, tileSize: number): Promise<TiledImage> {
  const response = await fetch(`/v1/pictures?tile_size=${tileSize}`, { method: "POST", body: file });
  if (!response.ok) throw await failureOf(response);
  return tiledImageOf(decodeTiles(await response.arrayBuffer()));
}

/** Signs in with a token, which the service keeps in a cookie. */
export async function signIn(token: string): Promise<void> {
  await getJson<"begin_session">("/v1/session", { method: "POST", headers: { Authorization: `Bearer ${token}` } });
}

export async function getSession(): Promise<Session> {
  return getJson<"get_session">("/v1/session");
}

export async function signOut(): Promise<void> {
  await fetch("/v1/session", { method: "DELETE" });
}

export async function getConvergence(id: string): Promise<ConvergencePoint[]> {
  return (await getJson<"get_convergence">(`${renderAddress(id)}/convergence`)).points;
}

export async function listWorkers(): Promise<Worker[]> {
  return (await getJson<"list_workers">("/v1/workers")).workers;
}

export function renderAddress(id: string): string {
  return `/v1/renders/${encodeURIComponent(id)}`;
}

/** Has the service make such a picture; it keeps it for those who ask next. */
export async function makePicture(id: string, name: string): Promise<void> {
  const response = await fetch(derivedAddress(id, name));
  if (!response.ok) throw await failureOf(response);
  await response.blob();
}

/** What the operation answers at this address. */
export async function getJson<Name extends keyof operations>(address: string, options: RequestInit = {}): Promise<Answer<Name>> {
  const response = await fetch(address, options);
  observeDate(response.headers.get("date"));
  if (!response.ok) throw await failureOf(response);
  return (await response.json()) as Answer<Name>;
}

/** The words of an RFC 9457 problem, or the HTTP status where there are none. */
async function failureOf(response: Response): Promise<ServiceError> {
  const problem = (await response.json().catch(() => ({}))) as Partial<ProblemDetails>;
  const text = problem.detail ?? problem.title ?? `${response.status} ${response.statusText}`;
  return new ServiceError(response.status, text, problem.problems);
}
