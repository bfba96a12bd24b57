/** The stream of render events, reconnected for as long as the page is open. */
import type { Render } from "./types.ts";

export interface EventListeners {
  /** Connected, also again after a break: what was missed must be fetched. */
  onOpen: () => void;
  onBreak: () => void;
  onRender: (render: Render) => void;
}

const firstDelay_ms = 500;
const longestDelay_ms = 5000;

/**
 * Listens to /v1/events: one connection for the whole page, since browsers allow six per host.
 * EventSource's own reconnecting gives up after an HTTP error (a proxy's 502 while the service restarts), so it is done here.
 */
export function listen(listeners: EventListeners): void {
  let delay_ms = firstDelay_ms;

  const connect = (): void => {
    const source = new EventSource("/v1/events");
    source.onopen = () => {
      delay_ms = firstDelay_ms;
      listeners.onOpen();
    };
    source.onerror = () => {
      source.close();
      listeners.onBreak();
      setTimeout(connect, delay_ms);
      delay_ms = Math.min(longestDelay_ms, 2 * delay_ms);
    };
    source.addEventListener("render", (event: MessageEvent<string>) => {
      listeners.onRender(JSON.parse(event.data) as Render);
    });
  };

  connect();
}
