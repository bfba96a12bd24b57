/** Keeps how the image is looked at in the address. */
import { fromQuery, type Memory, toQuery } from "./memory.ts";
import type { Viewer } from "./viewer.ts";

/** Milliseconds: browsers refuse addresses that change with every step of a slider. */
const rest = 300;

/** Shows the image as the address says; gives what needs the image: the region that is chosen there, and where it lies. */
export function recall(viewer: Viewer, canCompare: boolean): Pick<Memory, "chosen" | "placement"> {
  const { chosen, placement, show, side, wipe, ...look } = fromQuery(location.hash.split("?")[1] ?? "");
  if (canCompare) viewer.change({ ...(side && { side }), ...(wipe !== undefined && { wipe }) });
  viewer.change(show && (canCompare || show !== "difference") ? { ...look, show } : look);
  return { ...(chosen && { chosen }), ...(placement && { placement }) };
}

/** Which axis the chart of the error has stands there as well. */
export function axisInAddress(): "time" | "samples" {
  return new URLSearchParams(location.hash.split("?")[1]).get("axis") === "samples" ? "samples" : "time";
}

export function rememberAxis(axis: "time" | "samples"): void {
  const [route = "#/", query] = location.hash.split("?");
  const others = (query ?? "").split("&").filter((part) => part && !part.startsWith("axis="));
  const parts = [...others, ...(axis === "samples" ? ["axis=samples"] : [])];
  history.replaceState(null, "", `${route}${parts.length > 0 ? `?${parts.join("&")}` : ""}`);
}

function withAxis(query: string): string {
  return [query, axisInAddress() === "samples" ? "axis=samples" : ""].filter(Boolean).join("&");
}

/** What writes it, a moment after a change. */
export function rememberer(viewer: Viewer): () => void {
  const [route = "#/"] = location.hash.split("?");
  let timer = 0;
  return () => {
    timer ||= window.setTimeout(() => {
      timer = 0;
      const query = withAxis(toQuery({ ...viewer.look, isAuto: viewer.isAuto, placement: viewer.isFitted ? undefined : viewer.placement }));
      const address = `${route}${query ? `?${query}` : ""}`;
      if (location.hash.split("?")[0] === route && location.hash !== address) history.replaceState(null, "", address);
    }, rest);
  };
}
