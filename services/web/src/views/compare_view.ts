/** Two images of one size: a render beside another, or beside an EXR from disk. */
import { ConvergenceChart } from "../convergence/chart.ts";
import { together, usable } from "../convergence/points.ts";
import { element, section, setText } from "../dom.ts";
import type { TiledImage } from "../image/tiled_image.ts";
import { ImageSource } from "../image/image_source.ts";
import { compareRoute, renderRoute } from "../router.ts";
import { getConvergence, readPicture, tilesAddress } from "../service/client.ts";
import type { Renders } from "../service/renders.ts";
import type { Render } from "../service/types.ts";
import { type RenderImage, renderImage } from "../viewer/render_image.ts";
import { select } from "../viewer/controls.ts";
import { sides } from "../viewer/sides.ts";
import type { View } from "./view.ts";

export function compareView(first: string, second: string | undefined, renders: Renders): View {
  const problem = element("p", { class: "problem", role: "alert" });
  let other: TiledImage | undefined;
  const bothThere = (): void => {
    const film = image.viewer?.images.first;
    if (!film || !other) return;
    if (film.width !== other.width || film.height !== other.height) {
      setText(problem, `The images have different sizes: ${film.width} × ${film.height} and ${other.width} × ${other.height}.`);
      return;
    }
    image.viewer?.setImage("second", other);
    tools.show();
  };
  const image = renderImage(first, { canCompare: true, onImage: bothThere });
  const tools = sides(image.viewer);
  image.node.prepend(tools.node);
  const source = second === undefined ? undefined : secondSource(second, image, (film) => { other = film; bothThere(); });
  const chart = curves(first, second, renders);
  const heading = element("h1", { tabindex: "-1" }, "Compare");
  const choice = chooser(first, second, renders, async (file) => {
    try {
      setText(problem, "");
      other = await readPicture(file, image.viewer?.images.first?.tileSize ?? 32);
      bothThere();
    } catch (error) {
      setText(problem, error instanceof Error ? error.message : String(error));
    }
  });
  const node = element("div", { class: "compare" }, element("p", { class: "back" }, element("a", { href: renderRoute(first) }, "← The render")), heading, choice.node, problem, image.node, chart.node);
  const update = (): void => {
    choice.update();
    const render = renders.get(first);
    if (render) image.show(render);
  };
  update();
  const unsubscribe = [
    renders.subscribe(update),
    renders.subscribeTiles((event) => {
      if (event.render === first) image.refresh();
      if (event.render === second) source?.request();
    }),
  ];
  renders.watch(second === undefined ? [first] : [first, second]);
  image.refresh();
  source?.request();
  return {
    node,
    title: "Compare",
    close: () => {
      for (const stop of unsubscribe) stop();
      renders.watch([]);
      source?.close();
      image.close();
      chart.close();
    },
  };
}

function secondSource(id: string, image: RenderImage, onImage: (image: TiledImage) => void): ImageSource {
  return new ImageSource(tilesAddress(id), {
    onImage,
    onTiles: (tiles) => {
      if (image.viewer?.images.second) image.viewer.putTiles("second", tiles);
    },
  });
}

/** Which images are compared: names, another render of the same size, or a file. */
function chooser(first: string, second: string | undefined, renders: Renders, onFile: (file: File) => Promise<void>): { node: HTMLElement; update: () => void } {
  const names = element("p", { class: "versus" });
  const others = element("span", {});
  const input = element("input", { type: "file", accept: ".exr", id: "reference" });
  input.addEventListener("change", () => {
    const file = input.files?.[0];
    if (file) void onFile(file).then(() => { setText(names, `${nameOf(renders.get(first), first)} and ${file.name}`); });
  });
  const node = element("div", { class: "chooser" }, names, others, element("label", { class: "file", for: "reference" }, "Reference EXR ", input));
  let offered = "";
  const update = (): void => {
    const base = renders.get(first);
    const same = renders.newestFirst().filter((render) => render.id !== first && render.width === base?.width && render.height === base.height);
    if (!input.files?.length) setText(names, second === undefined ? nameOf(base, first) : `${nameOf(base, first)} and ${nameOf(renders.get(second), second)}`);
    const key = same.map(({ id }) => id).join();
    if (key === offered && offered) return;
    offered = key;
    const options: [string, string][] = [["", "Choose a render"], ...same.map((render): [string, string] => [render.id, nameOf(render, render.id)])];
    const box = select("Second", options, second ?? "", () => undefined);
    others.replaceChildren(patient(box, (id) => { if (id && id !== second) location.hash = compareRoute(first, id); }));
  };
  return { node, update };
}

/** A choice that leads away: by keys with Enter or when the focus leaves it, as arrow keys pass by others on their way. */
function patient(box: HTMLElement, go: (value: string) => void): HTMLElement {
  let byKeys = false;
  const act = (event: Event): void => { if (event.target instanceof HTMLSelectElement) go(event.target.value); };
  box.addEventListener("pointerdown", () => { byKeys = false; });
  box.addEventListener("keydown", (event) => {
    byKeys = true;
    if (event.key === "Enter") act(event);
  });
  box.addEventListener("change", (event) => { if (!byKeys) act(event); });
  box.addEventListener("focusout", act);
  return box;
}

function nameOf(render: Render | undefined, id: string): string {
  return render?.name ? `${render.name} (${id}, engine ${render.engine})` : id;
}

/** Both errors over the samples per pixel, on one chart. */
function curves(first: string, second: string | undefined, renders: Renders): { node: HTMLElement; close: () => void } {
  const plot = element("div", { class: "plot" });
  const chart = new ConvergenceChart(plot);
  const draw = async (): Promise<void> => {
    const [a, b] = await Promise.all([getConvergence(first), second === undefined ? [] : getConvergence(second)]);
    const both = together(usable(a, "samples"), usable(b, "samples"));
    const name = (id: string): string => renders.get(id)?.name ?? id;
    chart.show(
      {
        x: both.x,
        lines: [
          { label: `1: ${name(first)}`, values: both.first, colour: "--accent", kind: "points" },
          ...(second === undefined ? [] : [{ label: `2: ${name(second)}`, values: both.second, colour: "--cancelled", kind: "points" as const }]),
        ],
      },
      "samples",
    );
  };
  const timer = setInterval(() => void draw().catch(() => undefined), 3000);
  draw().catch(() => undefined);
  const node = section("curves", "Convergence of both", element("figure", { "aria-label": "Relative error over samples per pixel" }, plot));
  return {
    node,
    close: () => {
      clearInterval(timer);
      chart.close();
    },
  };
}
