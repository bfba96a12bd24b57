/** All renders known to the page, newest state of each; kept fresh by the event stream. */
import { getRender, listRenders } from "./client.ts";
import { EventStream } from "./events.ts";
import type { Render, RenderPage, TilesEvent } from "./types.ts";

export type Connection = "connecting" | "live" | "reconnecting" | "signed out";

type Listener = () => void;

export class Renders {
  connection: Connection = "connecting";
  /** The first page has arrived: an empty list means that there is nothing. */
  loaded = false;
  nextPageToken = "";
  /** Counts connections; a view that sees it grow fetches what events do not carry. */
  connections = 0;

  readonly #byId = new Map<string, Render>();
  /** Until something changes: it is asked for several times at each change. */
  #sorted: Render[] | undefined;
  readonly #listeners = new Set<Listener>();

  readonly #tilesListeners = new Set<(event: TilesEvent) => void>();
  readonly #stream = new EventStream({
    onOpen: () => {
      this.connections += 1;
      this.#setConnection("live");
      if (this.#watched.length === 0) void this.#refresh();
    },
    onBreak: () => {
      this.#setConnection("reconnecting");
    },
    onUnknown: () => {
      this.#setConnection("signed out");
    },
    onRender: (render) => {
      this.put(render);
    },
    onTiles: (event) => {
      for (const listener of [...this.#tilesListeners]) listener(event);
    },
  });
  #watched: readonly string[] = [];

  /** Connects; after signing in, again: until that is done nobody is known to be signed out. */
  start(): void {
    this.#setConnection("connecting");
    this.#stream.connect();
  }

  /** Follows these renders and their tiles; none: the newest renders. */
  watch(ids: readonly string[]): void {
    this.#watched = ids;
    this.#stream.watch(ids);
  }

  /** Calls back when tiles of a watched render have new samples, until the returned function is called. */
  subscribeTiles(listener: (event: TilesEvent) => void): () => void {
    this.#tilesListeners.add(listener);
    return () => this.#tilesListeners.delete(listener);
  }

  /** Calls back after every change, until the returned function is called. */
  subscribe(listener: Listener): () => void {
    this.#listeners.add(listener);
    return () => this.#listeners.delete(listener);
  }

  get(id: string): Render | undefined {
    return this.#byId.get(id);
  }

  newestFirst(): readonly Render[] {
    this.#sorted ??= [...this.#byId.values()].sort((a, b) => b.created - a.created || (a.id < b.id ? 1 : -1));
    return this.#sorted;
  }

  /** Takes a render unless something newer is known. */
  put(render: Render): void {
    const known = this.#byId.get(render.id);
    if (newer(render, known) === known) return;
    this.#byId.set(render.id, render);
    this.#notify();
  }

  /** The service has it no more. */
  forget(id: string): void {
    this.#byId.delete(id);
    this.#notify();
  }

  /** Fetches one render; throws ServiceError where there is none. */
  async fetch(id: string): Promise<void> {
    this.put(await getRender(id));
  }

  async fetchNextPage(): Promise<void> {
    this.#take(await listRenders(this.nextPageToken));
  }

  /** Fetches the renders of a group, at most `most`. */
  async fetchGroup(name: string, most = 1000): Promise<void> {
    let token = "";
    let found = 0;
    do {
      const page = await listRenders(token, name);
      token = page.next_page_token;
      found += page.renders.length;
      for (const render of page.renders) this.#byId.set(render.id, newer(render, this.#byId.get(render.id)));
    } while (token && found < most);
    this.#notify();
  }

  /** Fetches the newest renders with all these words, which may be older than all that are known. */
  async search(words: string): Promise<void> {
    const page = await listRenders("", "", words);
    for (const render of page.renders) this.#byId.set(render.id, newer(render, this.#byId.get(render.id)));
    this.#notify();
  }

  async #refresh(): Promise<void> {
    try {
      const page = await listRenders();
      this.#forgetMissing(page);
      this.loaded = true;
      this.#take(page);
    } catch {
      // The stream breaks too when the service is gone; the next connection fetches again.
    }
  }

  #take(page: RenderPage): void {
    this.nextPageToken = page.next_page_token;
    for (const render of page.renders) this.#byId.set(render.id, newer(render, this.#byId.get(render.id)));
    this.#notify();
  }

  /** Drops what the first page should hold and does not: the service may have come back with another data folder. */
  #forgetMissing(page: RenderPage): void {
    const present = new Set(page.renders.map((render) => render.id));
    const oldest = page.next_page_token ? (page.renders.at(-1)?.created ?? 0) : 0;
    for (const { id, created } of this.#byId.values()) {
      if (created >= oldest && !present.has(id)) this.#byId.delete(id);
    }
  }

  #setConnection(connection: Connection): void {
    this.connection = connection;
    this.#notify();
  }

  #notify(): void {
    this.#sorted = undefined;
    for (const listener of [...this.#listeners]) listener();
  }
}

function newer(render: Render, known: Render | undefined): Render {
  return known && known.sequence > render.sequence ? known : render;
}
