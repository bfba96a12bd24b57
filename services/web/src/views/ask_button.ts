/** A button that asks first: what can't be undone, or what needs numbers. */
import { announce, element, setText } from "../dom.ts";
import { cancelRender, deleteRender } from "../service/client.ts";
import type { Render } from "../service/types.ts";

export interface Question {
  /** On the button; the dialog's own button says the same. */
  act: string;
  title: string;
  text: string;
  /** On the button that changes nothing. */
  keep: string;
  /** Before the reason why it failed. */
  failed: string;
}

let asked = 0;

/** `fields`: what is to be filled in before; without, the act can't be undone. */
export function askButton(question: Question, act: () => Promise<void>, fields?: HTMLElement): { button: HTMLElement; dialog: HTMLDialogElement } {
  const look = { type: "button", class: fields ? "" : "danger" };
  const title = `question-${++asked}`;
  const button = element("button", look, `${question.act}…`);
  const problem = element("p", { class: "problem", role: "alert" });
  const keep = element("button", { type: "button", autofocus: "" }, question.keep);
  const confirm = element("button", look, question.act);
  const dialog = element(
    "dialog",
    { "aria-labelledby": title },
    element("h2", { id: title }, question.title),
    element("p", {}, question.text),
    ...(fields ? [fields] : []),
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
  const confirmed = async (): Promise<void> => {
    confirm.disabled = true;
    try {
      await act();
      dialog.close();
    } catch (error) {
      setText(problem, `${question.failed}: ${error instanceof Error ? error.message : String(error)}`);
    }
    confirm.disabled = false;
  };
  confirm.addEventListener("click", () => void confirmed());
  fields?.addEventListener("keydown", (event) => { if (event.key === "Enter") void confirmed(); });
  return { button, dialog };
}

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

/** Of a render that has ended. */
export function deleteButton(id: string, onDeleted: () => void): { button: HTMLElement; dialog: HTMLElement } {
  const question = {
    act: "Delete render",
    title: "Delete this render?",
    text: "Its images, numbers and history are gone for good, and files that no other render uses.",
    keep: "Keep it",
    failed: "Not deleted",
  };
  return askButton(question, async () => {
    await deleteRender(id);
    announce("The render is deleted");
    onDeleted();
  });
}
