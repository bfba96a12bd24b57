/** How far the renders of a group are, together. */
import { element, setText } from "../dom.ts";
import { formatDuration } from "../format.ts";
import { getGroup } from "../service/client.ts";
import { serviceNow } from "../service/clock.ts";
import { costOf } from "../service/price.ts";
import type { Group } from "../service/types.ts";

/** Asked of the service at most so often, however often renders change. */
const pause = 2000;

export function groupLine(name: string): { node: HTMLElement; refresh: () => void; close: () => void } {
  const bar = element("progress", { max: "1", value: "0", "aria-label": "Done of the whole group" });
  const text = element("p", { role: "status" });
  const node = element("div", { class: "group" }, bar, text);
  let timer: ReturnType<typeof setTimeout> | undefined;
  const load = async (): Promise<void> => {
    try {
      const group = await getGroup(name);
      bar.value = group.fraction;
      setText(text, groupText(group));
    } catch (error) {
      setText(text, error instanceof Error ? error.message : String(error));
    }
  };
  void load();
  return {
    node,
    refresh: () => {
      timer ??= setTimeout(() => {
        timer = undefined;
        void load();
      }, pause);
    },
    close: () => { clearTimeout(timer); },
  };
}

export function groupText(group: Group): string {
  const left = group.predicted_end > 0 ? Math.max(0, group.predicted_end - serviceNow()) : 0;
  return [
    `${group.ended} of ${group.renders} renders have ended, ${(100 * group.fraction).toFixed(1)} % is done`,
    group.failed > 0 ? `${group.failed} failed or were cancelled` : "",
    `CPU ${formatDuration(group.cpu_seconds)}`,
    costOf(group.cpu_seconds),
    left > 0 ? `those that run end in ${formatDuration(left)}` : "",
  ].filter(Boolean).join(" · ");
}
