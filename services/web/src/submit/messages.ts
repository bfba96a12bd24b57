/** What is said of a scene and of the form: one line, and the places of what is wrong. */
import { element, setText } from "../dom.ts";
import { ServiceError } from "../service/client.ts";
import type { Problem } from "../service/types.ts";

export interface Messages {
  status: HTMLElement;
  problems: HTMLElement;
  say: (words: string) => void;
  failed: (error: unknown) => void;
  show: (problems: readonly Problem[]) => void;
  /** What it fails with stands there until the form is `corrected`, or tried again. */
  correctable: (work: () => Promise<void>) => Promise<void>;
  corrected: () => void;
}

export function messages(): Messages {
  const status = element("p", { role: "status" });
  const problems = element("ul", { class: "problems", role: "alert" });
  problems.hidden = true;
  /** What was said before the last failure; undefined where something else was said since. */
  let before: string | undefined;
  const say = (words: string): void => {
    before = undefined;
    setText(status, words);
  };
  const show = (found: readonly Problem[]): void => {
    problems.replaceChildren(...found.map(({ place, message }) => element("li", {}, element("code", {}, place), ` ${message}`)));
    problems.hidden = found.length === 0;
  };
  const failed = (error: unknown): void => {
    say(error instanceof Error ? error.message : String(error));
    show(error instanceof ServiceError ? error.problems : []);
  };
  const corrected = (): void => {
    if (before === undefined) return;
    say(before);
    show([]);
  };
  const correctable = async (work: () => Promise<void>): Promise<void> => {
    corrected();
    const ready = status.textContent;
    try {
      await work();
    } catch (error) {
      failed(error);
      before = ready;
      // On a phone it is far above the button.
      status.scrollIntoView({ block: "nearest" });
    }
  };
  return { status, problems, say, failed, show, correctable, corrected };
}
