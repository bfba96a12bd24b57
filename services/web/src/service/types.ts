/** The service's values, by the names that the page uses; openapi.d.ts has them from the service's own description. */
import type { components, operations } from "./openapi.d.ts";

type Schemas = components["schemas"];
type JsonOf<Response> = Response extends { content: { "application/json": infer Value } } ? Value : never;

/** What an operation answers when it succeeds. */
export type Answer<Name extends keyof operations> = JsonOf<operations[Name]["responses"][keyof operations[Name]["responses"] & (200 | 201)]>;

export type Render = Schemas["Render"];
export type RenderState = Schemas["RenderState"];
export type Group = Schemas["Group"];
export type RenderPage = Schemas["RenderPage"];
export type Region = Schemas["Region"];
export type UnmetPart = Schemas["UnmetPart"];
export type RegionReading = Schemas["Reading"];
export type LinearPolarisation = Schemas["LinearPolarisation"];
export type LearnedLight = Schemas["LearnedLight"];
export type Outline = Schemas["Outline"];
export type Measurement = Schemas["Measurement"];
export type Measurements = Schemas["Measurements"];
export type MeasuredRegions = Schemas["MeasuredRegions"];
export type Isolines = Schemas["Isolines"];
export type Glare = Schemas["Glare"];
export type Progress = Schemas["Progress"];
export type ConvergencePoint = Schemas["ConvergencePoint"];
export type CreateGroupRequest = Schemas["CreateGroupRequest"];
export type NewGroup = Schemas["NewGroup"];
export type SceneDocument = Schemas["SceneDocument"];
export type PreflightRequest = Schemas["PreflightRequest"];
export type PreflightReport = Schemas["PreflightReport"];
export type PreflightModel = Schemas["PreflightModel"];
export type ImportRequest = Schemas["ImportRequest"];
export type ImportedScene = Schemas["ImportedScene"];
export type Interval = Schemas["Interval"];
export type Usage = Schemas["Usage"];
export type Worker = Schemas["Worker"];
export type WorkOfWorker = Schemas["WorkOfWorker"];
export type WorkerHistory = Schemas["WorkerHistory"];
export type TileInProgress = Schemas["TileInProgress"];
export type TilesEvent = Schemas["TilesEvent"];
export type Problem = Schemas["Problem"];
export type ProblemDetails = Schemas["ProblemDetails"];
export type Session = Schemas["Session"];

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
