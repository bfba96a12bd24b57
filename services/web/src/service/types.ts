/** What the REST interface answers; the meaning of each field is in proto/nocturne/v1/render_service.proto. */
import type { Region } from "../image/film.ts";

export type RenderState =
  | "QUEUED"
  | "RUNNING"
  | "PAUSED"
  | "SUCCEEDED"
  | "STOPPED_EARLY"
  | "DEGRADED"
  | "FAILED"
  | "CANCELLED";

export interface Progress {
  ranges_done: number;
  ranges_planned: number;
  photons: number;
  rays: number;
  invalid_samples: number;
  /** Mean over pixels of samples merged. */
  mean_samples: number;
  /** Standard error of Y, root mean square over pixels, relative to the mean Y; 0 where unknown. */
  relative_error: number;
  /** Part of the error's square that the worst 1 % of the pixels have, and how many pixels carry it; 0 where unknown. */
  worst_share: number;
  effective_pixels: number;
  photons_per_second: number;
  cpu_seconds: number;
  /** Unix time in seconds, and processor seconds in all; 0 where there is nothing to go by. */
  predicted_end: number;
  predicted_cpu_seconds: number;
}

export interface Stop {
  relative_error: number;
  tile_relative_error: number;
  wall_seconds: number;
  cpu_seconds: number;
  until: string;
  until_time: number;
}

export interface Render {
  id: string;
  name: string;
  state: RenderState;
  reason: string;
  width: number;
  height: number;
  /** Samples per pixel asked for. */
  samples: number;
  scene_sha256: string;
  sequence: number;
  /** Unix times in seconds; 0 where it has not happened. */
  created: number;
  started: number;
  ended: number;
  stop: Stop;
  priority: number;
  owner: string;
  look_first: Region | null;
  progress: Progress;
}

export interface RenderPage {
  renders: Render[];
  next_page_token?: string;
}

export interface Worker {
  id: string;
  threads: number;
  photons_per_second: number;
  jobs_done: number;
  /** Why its results are not taken; empty: they are. */
  quarantine: string;
  /** Why it gets no jobs though it is not in quarantine; empty: it gets them. */
  incompatible: string;
}

export interface WorkerHistory {
  events: { unix_time: number; worker_id: string; what: string; reason: string }[];
  rates: { unix_time: number; threads: number; photons_per_second: number }[];
}

export interface NewRender {
  request_id: string;
  name: string;
  scene: unknown;
  width: number;
  height: number;
  samples: number;
  stop: Record<string, number | string>;
  priority: number;
}

/** An estimate and where the truth lies, with 95 %. */
export interface Interval {
  value: number;
  low: number;
  high: number;
}

/** A scene with something less, as a pilot measured it; errors are relative. */
export interface PreflightModel {
  without: string[];
  verdict: string;
  mean_bias: Interval;
  local_bias: Interval;
  cost_ratio: Interval;
  /** To the target; null: out of reach. */
  samples: number | null;
  cpu_seconds: number | null;
}

/** What a scene needs for an error. */
export interface Preflight {
  error: number;
  pilot: { heavy_tails: boolean };
  models: PreflightModel[];
  chosen: PreflightModel;
  saving: number;
  /** The chosen scene document. */
  document: Record<string, unknown>;
}

/** One row of the error history. */
export interface ErrorPoint {
  /** Seconds since the render started. */
  time_s: number;
  photons: number;
  samples: number;
  relative_error: number;
  worst_share: number;
  effective_pixels: number;
}

export function hasEnded(render: Render): boolean {
  return render.state !== "QUEUED" && render.state !== "RUNNING" && render.state !== "PAUSED";
}

export function hasImage(render: Render): boolean {
  return render.progress.mean_samples > 0;
}

/** How much is merged, 0 to 1. By samples, not by ranges: early ranges are much shorter than late ones. */
export function fractionDone(render: Render): number {
  return render.samples > 0 ? Math.min(1, render.progress.mean_samples / render.samples) : 0;
}
