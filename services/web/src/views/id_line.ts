/** A render's id, as the command line wants it, and a button that copies it. */
import { announce, element } from "../dom.ts";

export function idLine(id: string): HTMLElement {
  const text = element("code", {}, id);
  const copy = element("button", { type: "button", class: "quiet" }, "Copy id");
  copy.addEventListener("click", () => {
    // Without https there is no clipboard: then the id is selected, to be copied by hand.
    const copied = "clipboard" in navigator ? navigator.clipboard.writeText(id) : Promise.reject(new Error());
    copied.then(() => { announce("The id is copied"); }, () => { getSelection()?.selectAllChildren(text); });
  });
  return element("p", { class: "id" }, text, copy);
}
