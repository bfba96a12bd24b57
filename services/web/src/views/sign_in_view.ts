/** Asks for a token where the service wants one. */
import { element, setText } from "../dom.ts";
import { signIn } from "../service/client.ts";
import type { View } from "./view.ts";

export const signInTitle = "Sign in";

export function signInView(onSignedIn: () => void): View {
  const token = element("input", { type: "password", id: "token", autocomplete: "current-password", required: "", "aria-describedby": "token-note" });
  const problem = element("p", { class: "problem", role: "alert" });
  const button = element("button", { type: "submit", class: "primary" }, "Sign in");
  const form = element(
    "form",
    { class: "sign-in" },
    element("h1", { tabindex: "-1" }, signInTitle),
    element("p", {}, "This service asks for a token."),
    element("label", { for: "token" }, "Token"),
    token,
    problem,
    button,
    element("p", { class: "note", id: "token-note" }, "Made on the service's machine with ", element("code", {}, "nocturne token create NAME --scope submit"), ". Scripts of this page cannot read it; it goes when the browser closes."),
  );
  const send = async (): Promise<void> => {
    button.disabled = true;
    try {
      await signIn(token.value.trim());
      onSignedIn();
    } catch (error) {
      setText(problem, error instanceof Error ? error.message : String(error));
      token.select();
    }
    button.disabled = false;
  };
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    void send();
  });
  return { node: form, title: signInTitle, close: () => undefined };
}
