/** Addresses after the hash, so that the server needs no rewrites: #/ and #/renders/ID. */

export type Route = { page: "list" } | { page: "render"; id: string } | { page: "unknown" };

export function parseRoute(hash: string): Route {
  if (hash === "" || hash === "#" || hash === "#/") return { page: "list" };
  const id = /^#\/renders\/([^/]+)$/.exec(hash)?.[1];
  if (id === undefined) return { page: "unknown" };
  try {
    return { page: "render", id: decodeURIComponent(id) };
  } catch {
    return { page: "unknown" };
  }
}

export function renderRoute(id: string): string {
  return `#/renders/${encodeURIComponent(id)}`;
}
