/** Deleting a render that has ended, after a question. */
import { announce } from "../dom.ts";
import { deleteRender } from "../service/client.ts";
import { askButton } from "./ask_button.ts";

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
