/** What a pixel or a region of the image holds, in numbers. */
import { element, setText } from "../dom.ts";
import type { TiledImage, Reading, Region } from "../image/tiled_image.ts";
import type { Measured } from "../image/look.ts";
import type { RegionReading } from "../service/types.ts";
import { rowsOf } from "./readings.ts";

/** Milliseconds that a place must be looked at before the service is asked of it. */
const rest = 150;

export interface Inspector {
  node: HTMLElement;
  /** Reads the image anew where it was looked at. */
  refresh: () => void;
  showPixel: (pixel: { x: number; y: number }) => void;
  showRegion: (region: Region | undefined) => void;
  close: () => void;
}

/** Asks the service for a region's numbers with the errors of all of them; undefined: it knows nothing of this image. */
export type Ask = (region: Region) => Promise<RegionReading> | undefined;

/** `image`: what is looked at now; `measured`: what its numbers are. */
export function inspector(image: () => TiledImage | undefined, measured: () => Measured, ask: Ask): Inspector {
  const pixel = column("Pixel", "Point at the image, or use the arrow keys", measured, ask);
  const region = column("Region", window.matchMedia("(pointer: coarse)").matches ? "Press Region, then drag" : "Drag with Shift, or press Region first", measured, ask);
  let at: Region | undefined;
  let chosen: Region | undefined;
  const refresh = (): void => {
    pixel.show(at && image()?.read(at));
    region.show(chosen && image()?.read(chosen));
  };
  return {
    node: element("div", { class: "inspector", role: "group", "aria-label": "Inspector" }, pixel.node, region.node),
    refresh,
    showPixel: ({ x, y }) => {
      const current = image();
      if (!current || x < 0 || y < 0 || x >= current.width || y >= current.height) return;
      at = { x, y, width: 1, height: 1 };
      refresh();
    },
    showRegion: (wanted) => {
      chosen = wanted;
      refresh();
    },
    close: () => {
      pixel.close();
      region.close();
    },
  };
}

interface Column {
  node: HTMLElement;
  show: (reading: Reading | undefined) => void;
  close: () => void;
}

function column(title: string, hint: string, measured: () => Measured, ask: Ask): Column {
  const place = element("span", { class: "place" });
  const list = element("dl", { title: "After ±: half of the 95 % interval" });
  const invitation = element("p", { class: "note" }, hint);
  const node = element("section", { "aria-label": title }, element("h2", {}, title, place), invitation, list);
  list.hidden = true;
  let shown: Reading | undefined;
  let told: RegionReading | undefined;
  let isAsked = true;
  let timer = 0;
  const write = (): void => {
    list.hidden = !shown;
    invitation.hidden = !!shown;
    setText(place, shown ? placeText(shown.region) : "");
    if (shown) fill(list, rowsOf(shown, told, isAsked, measured()));
  };
  const request = async (region: Region): Promise<void> => {
    const answer = ask(region);
    isAsked = answer !== undefined;
    try {
      const found = await answer;
      if (shown && isSame(shown.region, region)) told = found;
    } catch {
      // The numbers of the image stay; the next tiles ask again.
      isAsked = false;
    }
    write();
  };
  return {
    node,
    show: (reading) => {
      const isNew = !reading || !shown || !isSame(reading.region, shown.region);
      if (isNew) told = undefined;
      shown = reading;
      write();
      // Tiles that come one after the other do not delay a pending request.
      if (isNew) window.clearTimeout(timer);
      if (isNew || timer === 0) {
        timer = window.setTimeout(() => {
          timer = 0;
          if (shown) void request(shown.region);
        }, rest);
      }
    },
    close: () => {
      window.clearTimeout(timer);
    },
  };
}

/** Rows stay as they are, so that what is selected stays selected; only their text changes. */
function fill(list: HTMLElement, rows: { name: string; text: string }[]): void {
  while (list.children.length > rows.length) list.lastElementChild?.remove();
  while (list.children.length < rows.length) list.append(element("div", {}, element("dt"), element("dd")));
  rows.forEach(({ name, text }, index) => {
    const [term, value] = list.children[index]?.children ?? [];
    if (term instanceof HTMLElement) setText(term, name);
    if (value instanceof HTMLElement) setText(value, text);
  });
}

function isSame(one: Region, other: Region): boolean {
  return one.x === other.x && one.y === other.y && one.width === other.width && one.height === other.height;
}

function placeText({ x, y, width, height }: Region): string {
  return width * height === 1 ? `${x}, ${y}` : `${x}, ${y}, ${width} × ${height}`;
}
