/** A page's content: a node, and what stops it. */
export interface View {
  node: HTMLElement;
  /** For the window's title. */
  title: string;
  close: () => void;
}
