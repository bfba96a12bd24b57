/** What can be done to renders that are there. */
import { getJson, renderAddress } from "./client.ts";
import type { Render } from "./types.ts";

/** No more work until it is resumed. */
export async function pauseRender(id: string): Promise<Render> {
  return getJson<"pause_render">(`${renderAddress(id)}:pause`, { method: "POST" });
}

/** Goes on with a paused render, or with the failed tiles of a degraded one. */
export async function resumeRender(id: string): Promise<Render> {
  return getJson<"resume_render">(`${renderAddress(id)}:resume`, { method: "POST" });
}

/** Samples per pixel in all, 0 for as many as before; an error, undefined for the one before. */
export async function extendRender(id: string, samples: number, relativeError: number | undefined): Promise<Render> {
  const stop = relativeError === undefined ? {} : { relative_error: relativeError };
  return getJson<"extend_render">(`${renderAddress(id)}:extend`, { method: "POST", body: JSON.stringify({ samples, stop }) });
}

/** 1 to 1000. */
export async function setPriority(id: string, priority: number): Promise<Render> {
  return getJson<"set_priority">(`${renderAddress(id)}:setPriority`, { method: "POST", body: JSON.stringify({ priority }) });
}

/** Words to sort renders by, instead of those that it has. */
export async function setTags(id: string, tags: string[]): Promise<Render> {
  return getJson<"set_tags">(`${renderAddress(id)}:setTags`, { method: "POST", body: JSON.stringify({ tags }) });
}

/** A new render with the same samples. */
export async function replayRender(id: string): Promise<Render> {
  const request = { request_id: [...crypto.getRandomValues(new Uint8Array(16))].map((byte) => byte.toString(16)).join("-") };
  return getJson<"replay_render">(`${renderAddress(id)}:replay`, { method: "POST", body: JSON.stringify(request) });
}
