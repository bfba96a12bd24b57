/** The REST calls that the page makes. Every failure is an Error whose message can be shown. */
import { observeDate } from "./clock.ts";
import type { ErrorPoint, Render, RenderPage, Worker } from "./types.ts";

export class ServiceError extends Error {
  readonly status: number;

  constructor(status: number, message: string) {
    super(message);
    this.status = status;
  }
}

export const previewAddress = (id: string, sequence?: number): string =>
  `${renderAddress(id)}/preview.png${sequence === undefined ? "" : `?v=${sequence}`}`;
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
  if (!response.ok) throw new ServiceError(response.status, await problemText(response));
  return response.json();
}

/** The words of an RFC 9457 problem, or the HTTP status where there are none. */
async function problemText(response: Response): Promise<string> {
  const problem = (await response.json().catch(() => ({}))) as { title?: string; detail?: string };
  return problem.detail ?? problem.title ?? `${response.status} ${response.statusText}`;
}
