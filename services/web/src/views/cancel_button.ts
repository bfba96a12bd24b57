/** Cancelling a render, after a question. */
import { announce } from "../dom.ts";
import { cancelRender } from "../service/client.ts";
import type { Render } from "../service/types.ts";
import { askButton } from "./ask_button.ts";

export function cancelButton(id: string, onCancelled: (render: Render) => void): { button: HTMLElement; dialog: HTMLElement } {
  const question = {
    act: "Cancel render",
    title: "Cancel this render?",
    text: "It stops and cannot be continued. The image so far is kept and can be downloaded.",
    keep: "Keep rendering",
    failed: "Not cancelled",
  };
  return askButton(question, async () => {
    onCancelled(await cancelRender(id));
    announce("The render is being cancelled");
  });
}
