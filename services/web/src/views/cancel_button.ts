/** Cancelling a render, after a question. */
import { announce, element, setText } from "../dom.ts";
import { cancelRender } from "../service/client.ts";
import type { Render } from "../service/types.ts";

export function cancelButton(id: string, onCancelled: (render: Render) => void): { button: HTMLElement; dialog: HTMLElement } {
  const button = element("button", { type: "button", class: "danger" }, "Cancel render…");
  const problem = element("p", { class: "problem", role: "alert" });
  const keep = element("button", { type: "button", autofocus: "" }, "Keep rendering");
  const confirm = element("button", { type: "button", class: "danger" }, "Cancel render");
  const dialog = element(
    "dialog",
    { "aria-labelledby": "cancel-title" },
    element("h2", { id: "cancel-title" }, "Cancel this render?"),
    element("p", {}, "It stops and cannot be continued. The image so far is kept and can be downloaded."),
    problem,
    element("div", { class: "actions" }, keep, confirm),
  );

  button.addEventListener("click", () => {
    setText(problem, "");
    dialog.showModal();
  });
  keep.addEventListener("click", () => {
    dialog.close();
  });
  const cancel = async (): Promise<void> => {
    confirm.disabled = true;
    try {
      onCancelled(await cancelRender(id));
      dialog.close();
      announce("The render is being cancelled");
    } catch (error) {
      setText(problem, `Not cancelled: ${error instanceof Error ? error.message : String(error)}`);
    }
    confirm.disabled = false;
  };
  confirm.addEventListener("click", () => void cancel());
  return { button, dialog };
}
