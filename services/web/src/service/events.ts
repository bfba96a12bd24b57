/** The stream of render events, reconnected for as long as the page is open. */
import { getSession, ServiceError } from "./client.ts";
import type { Render, TilesEvent } from "./types.ts";

export interface EventListeners {
  /** Connected, also again after a break: what was missed must be fetched. */
  onOpen: () => void;
  onBreak: () => void;
  /** The service wants a token, or another one. */
  onUnknown: () => void;
  onRender: (render: Render) => void;
  onTiles: (event: TilesEvent) => void;
}

const firstDelay_ms = 500;
const longestDelay_ms = 5000;

/**
 * Listens to /v1/events: one connection for the whole page, since browsers allow six per host.
 * EventSource's own reconnecting gives up after an HTTP error (a proxy's 502 while the service restarts), so it is done here.
 */
export class EventStream {
  readonly #listeners: EventListeners;
  #renders: readonly string[] = [];
  #source: EventSource | undefined;
  #timer: ReturnType<typeof setTimeout> | undefined;
  #delay_ms = firstDelay_ms;

  constructor(listeners: EventListeners) {
    this.#listeners = listeners;
  }

  /** Only these renders from now on, with their tiles; none: the newest ones, without. */
  watch(renders: readonly string[]): void {
    if (this.#source && renders.join() === this.#renders.join()) return;
    this.#renders = renders;
    this.connect();
  }

  connect(): void {
    clearTimeout(this.#timer);
    this.#source?.close();
    const query = new URLSearchParams(this.#renders.map((id) => ["render", id])).toString();
    const source = new EventSource(`/v1/events${query ? "?" : ""}${query}`);
    this.#source = source;
    source.onopen = () => {
      this.#delay_ms = firstDelay_ms;
      this.#listeners.onOpen();
    };
    source.onerror = () => {
      source.close();
      void this.#again(source);
    };
    source.addEventListener("render", (event: MessageEvent<string>) => {
      this.#listeners.onRender(JSON.parse(event.data) as Render);
    });
    source.addEventListener("tiles", (event: MessageEvent<string>) => {
      this.#listeners.onTiles(JSON.parse(event.data) as TilesEvent);
    });
  }

  /** An EventSource does not say why it broke; asking who we are does. */
  async #again(broken: EventSource): Promise<void> {
    this.#listeners.onBreak();
    const unknown = await getSession().then(() => false, (error: unknown) => error instanceof ServiceError && error.status === 401);
    // Reconnected in the meantime, as after signing in: the answer is outdated.
    if (this.#source !== broken) return;
    if (unknown) {
      this.#listeners.onUnknown();
      return;
    }
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => { this.connect(); }, this.#delay_ms);
    this.#delay_ms = Math.min(longestDelay_ms, 2 * this.#delay_ms);
  }
}
