/** Addresses after the hash; after a "?" stands how an image is looked at (viewer/memory.ts): #/, #/renders/ID, #/compare/ID[/ID], #/groups/NAME, #/workers, #/speed. */

export type Route =
  | { page: "list" }
  | { page: "render"; id: string }
  | { page: "group"; name: string }
  | { page: "compare"; first: string; second: string | undefined }
  | { page: "workers" }
  | { page: "speed" }
  | { page: "unknown" };

const fixedRoutes: Partial<Record<string, Route>> = {
  "": { page: "list" },
  "#": { page: "list" },
  "#/": { page: "list" },
  "#/workers": { page: "workers" },
  "#/speed": { page: "speed" },
};

export function parseRoute(address: string): Route {
  const [hash = ""] = address.split("?");
  const fixed = fixedRoutes[hash];
  if (fixed) return fixed;
  const [, page, first, second] = /^#\/(renders|compare|groups)\/([^/]+)(?:\/([^/]+))?$/.exec(hash) ?? [];
  if (first === undefined) return { page: "unknown" };
  try {
    if (page === "compare") return { page, first: decodeURIComponent(first), second: second && decodeURIComponent(second) };
    if (second !== undefined) return { page: "unknown" };
    return page === "groups" ? { page: "group", name: decodeURIComponent(first) } : { page: "render", id: decodeURIComponent(first) };
  } catch {
    return { page: "unknown" };
  }
}

/** `second`: a render; without it, one is chosen or a file is opened there. */
export function compareRoute(first: string, second?: string): string {
  return `#/compare/${encodeURIComponent(first)}${second === undefined ? "" : `/${encodeURIComponent(second)}`}`;
}

export function groupRoute(name: string): string {
  return `#/groups/${encodeURIComponent(name)}`;
}

export function renderRoute(id: string): string {
  return `#/renders/${encodeURIComponent(id)}`;
}
