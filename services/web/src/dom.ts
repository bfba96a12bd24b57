/** Building DOM nodes without a framework. */

type Child = Node | string;

interface Attributes {
  class?: string;
  id?: string;
  [name: string]: string | undefined;
}

/** An element with attributes and children; texts become text nodes, never markup. */
export function element<Tag extends keyof HTMLElementTagNameMap>(
  tag: Tag,
  attributes: Attributes = {},
  ...children: Child[]
): HTMLElementTagNameMap[Tag] {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value !== undefined) node.setAttribute(name, value);
  }
  node.append(...children);
  return node;
}

/** A part of a page with its heading; the page has no other of this id. */
export function section(id: string, title: string, ...children: Child[]): HTMLElement {
  return element("section", { "aria-labelledby": `${id}-title` }, element("h2", { id: `${id}-title` }, title), ...children);
}

/** A table; columns of buttons have empty headings. */
export function table(headings: readonly string[], rows: readonly HTMLElement[], caption?: string): HTMLElement {
  const head = element("tr", {}, ...headings.map((text) => (text ? element("th", { scope: "col" }, text) : element("td"))));
  return element(
    "table",
    {},
    ...(caption === undefined ? [] : [element("caption", {}, caption)]),
    ...(headings.length > 0 ? [element("thead", {}, head)] : []),
    element("tbody", {}, ...rows),
  );
}

/** One row of it: its name, and a cell for each of the others. */
export function tableRow(name: Child | readonly Child[], cells: readonly Child[]): HTMLElement {
  return element("tr", {}, element("th", { scope: "row" }, ...[name].flat()), ...cells.map((each) => element("td", {}, each)));
}

/** Holds what may be wider than a phone: it scrolls sideways, by keys as well. */
export function scroller(look: string, label: string): HTMLElement {
  return element("div", { class: look, tabindex: "0", role: "region", "aria-label": label });
}

/** Sets a text only when it differs: keeps selections, and live regions quiet. */
export function setText(node: Element, text: string): void {
  if (node.textContent !== text) node.textContent = text;
}

/** Calls that come before the next frame become one, in that frame. */
export function oncePerFrame(act: () => void): () => void {
  let frame = 0;
  return () => {
    frame ||= requestAnimationFrame(() => {
      frame = 0;
      act();
    });
  };
}

/** An element that index.html must have. */
export function required(id: string): HTMLElement {
  const node = document.getElementById(id);
  if (!node) throw new Error(`index.html has no #${id}`);
  return node;
}

/** Says a text to screen readers. */
export function announce(text: string): void {
  setText(required("announcer"), text);
}
