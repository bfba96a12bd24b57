/** The REST calls that the page makes. Every failure is an Error whose message can be shown. */
import { observeDate } from "./clock.ts";
import type { Region } from "../image/film.ts";
import type { ErrorPoint, NewRender, Preflight, Render, RenderPage, Worker, WorkerHistory } from "./types.ts";

export interface Problem {
  place: string;
  message: string;
}

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
export const imageAddress = (id: string): string => `${renderAddress(id)}/image.exr`;

export async function listRenders(pageToken = ""): Promise<RenderPage> {
  const query = new URLSearchParams({ page_size: "50" });
  if (pageToken) query.set("page_token", pageToken);
  return (await getJson(`/v1/renders?${query.toString()}`)) as RenderPage;
}

export async function getRender(id: string): Promise<Render> {
  return (await getJson(renderAddress(id))) as Render;
}

export async function cancelRender(id: string): Promise<Render> {
  return (await getJson(`${renderAddress(id)}:cancel`, { method: "POST" })) as Render;
}

/** Of a render that has ended; with its images. */
export async function deleteRender(id: string): Promise<void> {
  const response = await fetch(renderAddress(id), { method: "DELETE" });
  if (!response.ok) throw await failureOf(response);
}

/** A region of the film that gets its samples first; undefined: all parts are alike. */
export async function lookFirst(id: string, region: Region | undefined): Promise<Render> {
  return (await getJson(`${renderAddress(id)}:lookFirst`, { method: "POST", body: JSON.stringify(region ?? {}) })) as Render;
}

export async function getWhy(id: string): Promise<string> {
  return ((await getJson(`${renderAddress(id)}/explanation`)) as { sentence: string }).sentence;
}

export async function getAtWork(id: string): Promise<{ tile: number; worker: string }[]> {
  return ((await getJson(`${renderAddress(id)}/at-work`)) as { tiles: { tile: number; worker: string }[] }).tiles;
}

export async function getWorkerHistory(): Promise<WorkerHistory> {
  return (await getJson("/v1/workers/history")) as WorkerHistory;
}

/** Which of these files the service does not have yet. */
export async function missingAssets(digests: string[]): Promise<string[]> {
  return ((await getJson("/v1/assets:batchMissing", { method: "POST", body: JSON.stringify({ sha256: digests }) })) as { sha256: string[] }).sha256;
}

export async function storeAsset(sha256: string, content: Blob): Promise<void> {
  await getJson(`/v1/assets/${sha256}`, { method: "PUT", body: content });
}

export async function createRender(request: NewRender): Promise<Render> {
  return (await getJson("/v1/renders", { method: "POST", body: JSON.stringify(request) })) as Render;
}

/** What a scene needs for a relative error; takes minutes. */
export async function preflight(request: { scene: unknown; width: number; height: number; error: number }): Promise<Preflight> {
  return (await getJson("/v1/preflights", { method: "POST", body: JSON.stringify(request) })) as Preflight;
}

/** Signs in with a token, which the service keeps in a cookie. */
export async function signIn(token: string): Promise<void> {
  await getJson("/v1/session", { method: "POST", headers: { Authorization: `Bearer ${token}` } });
}

export async function getSession(): Promise<{ name: string; scopes: string[] }> {
  return (await getJson("/v1/session")) as { name: string; scopes: string[] };
}

export async function signOut(): Promise<void> {
  await fetch("/v1/session", { method: "DELETE" });
}

export async function getConvergence(id: string): Promise<ErrorPoint[]> {
  return ((await getJson(`${renderAddress(id)}/convergence`)) as { points: ErrorPoint[] }).points;
}

export async function listWorkers(): Promise<Worker[]> {
  return ((await getJson("/v1/workers")) as { workers: Worker[] }).workers;
}

function renderAddress(id: string): string {
  return `/v1/renders/${encodeURIComponent(id)}`;
}

async function getJson(address: string, options: RequestInit = {}): Promise<unknown> {
  const response = await fetch(address, options);
  observeDate(response.headers.get("date"));
  if (!response.ok) throw await failureOf(response);
  return response.json();
}

/** The words of an RFC 9457 problem, or the HTTP status where there are none. */
async function failureOf(response: Response): Promise<ServiceError> {
  const problem = (await response.json().catch(() => ({}))) as { title?: string; detail?: string; problems?: Problem[] };
  const text = problem.detail ?? problem.title ?? `${response.status} ${response.statusText}`;
  return new ServiceError(response.status, text, problem.problems);
}
