/**
 * Reads OpenEXR images that people bring as a reference: scan lines, one part, uncompressed or ZIP; half, float or uint channels
 * X, Y, Z, or R, G, B, or Y. The format: "OpenEXR File Layout", openexr.com. Every size is checked against the file.
 */
import { apply, inverse, type Matrix, xyzToSrgb } from "./colour.ts";
import { Film, type Region } from "./film.ts";

interface Channel {
  name: string;
  /** 0 uint, 1 half, 2 float. */
  type: number;
}

interface Header {
  channels: Channel[];
  compression: number;
  width: number;
  height: number;
  /** Where the table of offsets begins. */
  end: number;
}

/** Of a block: ZIPS and none have one line, ZIP 16. */
const linesOf: Record<number, number> = { 0: 1, 2: 1, 3: 16 };
const largestPixels = 2 ** 26;

/** Throws Error, fit to be shown. Y is taken as it is; R, G, B as linear sRGB. Samples are 1 where the file has no channel n. */
export async function readExr(bytes: ArrayBuffer, tileSize: number): Promise<Film> {
  const view = new DataView(bytes);
  const header = readHeader(view);
  const planes = await readPlanes(view, header);
  return toFilm(header, planes, tileSize);
}

function readHeader(view: DataView): Header {
  if (view.byteLength < 8 || view.getUint32(0, true) !== 20000630) throw new Error("This is no OpenEXR file.");
  if ((view.getUint32(4, true) & 0x1a00) !== 0) throw new Error("Tiled, deep and multi-part EXR files cannot be read here; save it as scan lines.");
  const header: Header = { channels: [], compression: 0, width: 0, height: 0, end: 0 };
  let at = 8;
  const text = (): string => {
    const start = at;
    while (at < view.byteLength && view.getUint8(at) !== 0) at += 1;
    at += 1;
    return new TextDecoder().decode(new Uint8Array(view.buffer, start, at - 1 - start));
  };
  for (let name = text(); name !== ""; name = text()) {
    text();
    const size = view.getInt32(at, true);
    at += 4;
    if (size < 0 || at + size > view.byteLength) throw new Error("The EXR file is cut short.");
    takeAttribute(header, name, view, at, size);
    at += size;
  }
  header.end = at;
  check(header);
  return header;
}

function takeAttribute(header: Header, name: string, view: DataView, at: number, size: number): void {
  if (name === "channels") header.channels = readChannels(view, at, at + size);
  if (name === "compression") header.compression = view.getUint8(at);
  if (name === "dataWindow") {
    header.width = view.getInt32(at + 8, true) - view.getInt32(at, true) + 1;
    header.height = view.getInt32(at + 12, true) - view.getInt32(at + 4, true) + 1;
  }
}

function readChannels(view: DataView, from: number, to: number): Channel[] {
  const channels: Channel[] = [];
  let at = from;
  while (at < to && view.getUint8(at) !== 0) {
    const start = at;
    while (at < to && view.getUint8(at) !== 0) at += 1;
    const name = new TextDecoder().decode(new Uint8Array(view.buffer, start, at - start));
    channels.push({ name, type: view.getInt32(at + 1, true) });
    if (view.getInt32(at + 9, true) !== 1 || view.getInt32(at + 13, true) !== 1) throw new Error(`Channel ${name} is subsampled, which cannot be read here.`);
    at += 17;
  }
  return channels;
}

function check({ width, height, compression }: Header): void {
  if (width < 1 || height < 1 || width * height > largestPixels) throw new Error(`The EXR has ${width} x ${height} pixels; at most ${largestPixels} in all.`);
  if (!(compression in linesOf)) throw new Error("This compression of EXR cannot be read here; save it with ZIP or without compression.");
}

async function readPlanes(view: DataView, header: Header): Promise<Map<string, Float32Array>> {
  const { channels, width, height } = header;
  const lines = linesOf[header.compression] ?? 1;
  const planes = new Map(channels.map(({ name }) => [name, new Float32Array(width * height)]));
  const lineBytes = channels.reduce((sum, { type }) => sum + width * (type === 1 ? 2 : 4), 0);
  for (let block = 0; block * lines < height; block += 1) {
    const at = Number(view.getBigUint64(header.end + 8 * block, true));
    const size = view.getInt32(at + 4, true);
    const rows = Math.min(lines, height - block * lines);
    const packed = new Uint8Array(view.buffer, at + 8, size);
    // What does not get smaller is stored as it is.
    const data = header.compression === 0 || size === rows * lineBytes ? packed : await unzip(packed, rows * lineBytes);
    takeBlock(data, header, block * lines, rows, planes);
  }
  return planes;
}

/** zlib, then differences of neighbouring bytes, then two halves that were interleaved. */
async function unzip(packed: Uint8Array, size: number): Promise<Uint8Array> {
  const stream = new Blob([packed as BlobPart]).stream().pipeThrough(new DecompressionStream("deflate"));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  if (bytes.length !== size) throw new Error("The EXR file is damaged: a block has the wrong length.");
  for (let i = 1; i < size; i += 1) bytes[i] = ((bytes[i - 1] ?? 0) + (bytes[i] ?? 0) - 128) & 255;
  const half = (size + 1) >> 1;
  return Uint8Array.from({ length: size }, (_, i) => bytes[(i & 1) === 0 ? i >> 1 : half + (i >> 1)] ?? 0);
}

function takeBlock(data: Uint8Array, { channels, width }: Header, first: number, rows: number, planes: ReadonlyMap<string, Float32Array>): void {
  const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
  let at = 0;
  for (let row = 0; row < rows; row += 1) {
    for (const { name, type } of channels) {
      const plane = planes.get(name);
      for (let x = 0; x < width; x += 1) {
        if (plane) plane[(first + row) * width + x] = type === 0 ? view.getUint32(at, true) : type === 1 ? half(view.getUint16(at, true)) : view.getFloat32(at, true);
        at += type === 1 ? 2 : 4;
      }
    }
  }
}

/** IEEE 754 binary16. */
function half(bits: number): number {
  const sign = bits & 0x8000 ? -1 : 1;
  const exponent = (bits >> 10) & 31;
  const fraction = bits & 1023;
  if (exponent === 0) return sign * fraction * 2 ** -24;
  if (exponent === 31) return fraction ? NaN : sign * Infinity;
  return sign * (1 + fraction / 1024) * 2 ** (exponent - 15);
}

const unchanged: Matrix = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

/** Planes of what becomes X, Y and Z, how, and the standard error where there is one. */
interface Meaning {
  planes: [Float32Array, Float32Array, Float32Array];
  matrix: Matrix;
  error: Float32Array | undefined;
}

function meaningOf(planes: ReadonlyMap<string, Float32Array>): Meaning {
  const take = (names: string[], matrix: Matrix): Meaning | undefined => {
    const [a, b, c] = names.map((name) => planes.get(name));
    return a && b && c && { planes: [a, b, c], matrix, error: planes.get("Y.stderr") };
  };
  const found = take(["X", "Y", "Z"], unchanged) ?? take(["R", "G", "B"], inverse(xyzToSrgb)) ?? take(["Y", "Y", "Y"], unchanged);
  if (!found) throw new Error("The EXR has neither channels X, Y, Z, nor R, G, B, nor Y.");
  return found;
}

function toFilm({ width, height }: Header, planes: ReadonlyMap<string, Float32Array>, tileSize: number): Film {
  const meaning = meaningOf(planes);
  const samples = planes.get("n");
  const film = new Film(width, height, tileSize);
  const columns = Math.ceil(width / tileSize);
  for (let index = 0; index < columns * Math.ceil(height / tileSize); index += 1) {
    const [x, y] = [(index % columns) * tileSize, Math.floor(index / columns) * tileSize];
    const area = { x, y, width: Math.min(tileSize, width - x), height: Math.min(tileSize, height - y) };
    const of = samples?.[y * width + x] ?? 1;
    film.put({ index, ...area, samples: of, invalid_samples: 0, revision: 0, pixels: pixelsOf(meaning, area, width) });
  }
  return film;
}

function pixelsOf({ planes: [a, b, c], matrix, error }: Meaning, area: Region, stride: number): Float32Array {
  const pixels = new Float32Array(4 * area.width * area.height);
  for (let i = 0; i < area.width * area.height; i += 1) {
    const from = (area.y + Math.floor(i / area.width)) * stride + area.x + (i % area.width);
    pixels.set([...apply(matrix, [a[from] ?? 0, b[from] ?? 0, c[from] ?? 0]), error?.[from] ?? 0], 4 * i);
  }
  return pixels;
}
