/** Reads ZIP archives in the browser: stored and deflated members, within bounds. The format: PKWARE APPNOTE 6.3. */

const endMarker = 0x06054b50;
const entryMarker = 0x02014b50;
const endBytes = 22;
const longestComment = 65535;

export const mostFiles = 10_000;
const mostBytes = 4 * 2 ** 30;

/** Files by path. Throws Error, fit to be shown. */
export async function readZip(archive: Blob): Promise<Map<string, Blob>> {
  const tailStart = Math.max(0, archive.size - endBytes - longestComment);
  const tail = new DataView(await archive.slice(tailStart).arrayBuffer());
  const end = findEnd(tail);
  const count = tail.getUint16(end + 10, true);
  const offset = tail.getUint32(end + 16, true);
  if (count > mostFiles) throw new Error(`The archive has ${count} files; at most ${mostFiles}.`);
  const directory = new DataView(await archive.slice(offset, offset + tail.getUint32(end + 12, true)).arrayBuffer());
  const files = new Map<string, Blob>();
  let at = 0;
  let total = 0;
  for (let number = 0; number < count; number += 1) {
    if (at + 46 > directory.byteLength || directory.getUint32(at, true) !== entryMarker) throw new Error("The archive is damaged.");
    const entry = readEntry(directory, at);
    total += entry.size;
    if (total > mostBytes) throw new Error("The archive's files have more than 4 GiB.");
    if (!entry.name.endsWith("/")) files.set(safe(entry.name), await extract(archive, entry));
    at = entry.next;
  }
  return files;
}

interface Entry {
  name: string;
  method: number;
  packed: number;
  size: number;
  offset: number;
  next: number;
}

function findEnd(tail: DataView): number {
  for (let at = tail.byteLength - endBytes; at >= 0; at -= 1) if (tail.getUint32(at, true) === endMarker) return at;
  throw new Error("This is no ZIP archive.");
}

function readEntry(directory: DataView, at: number): Entry {
  const nameBytes = directory.getUint16(at + 28, true);
  const more = directory.getUint16(at + 30, true) + directory.getUint16(at + 32, true);
  return {
    name: new TextDecoder().decode(new Uint8Array(directory.buffer, at + 46, nameBytes)),
    method: directory.getUint16(at + 10, true),
    packed: directory.getUint32(at + 20, true),
    size: directory.getUint32(at + 24, true),
    offset: directory.getUint32(at + 42, true),
    next: at + 46 + nameBytes + more,
  };
}

async function extract(archive: Blob, { name, method, packed, size, offset }: Entry): Promise<Blob> {
  const local = new DataView(await archive.slice(offset, offset + 30).arrayBuffer());
  const start = offset + 30 + local.getUint16(26, true) + local.getUint16(28, true);
  const content = archive.slice(start, start + packed);
  if (method === 0) return content;
  if (method !== 8) throw new Error(`${name} is packed in a way that cannot be read here; use ordinary ZIP compression.`);
  return inflate(content, name, size);
}

/** Stops as soon as there is more than was declared: an archive must not unpack to anything. */
async function inflate(content: Blob, name: string, size: number): Promise<Blob> {
  const reader = content.stream().pipeThrough(new DecompressionStream("deflate-raw")).getReader();
  const parts: BlobPart[] = [];
  let found = 0;
  for (let part = await reader.read(); !part.done; part = await reader.read()) {
    found += part.value.length;
    if (found > size) break;
    parts.push(part.value);
  }
  if (found !== size) throw new Error(`${name} in the archive has not the length that it says.`);
  return new Blob(parts);
}

function safe(name: string): string {
  if (name.startsWith("/") || name.split("/").includes("..")) throw new Error(`${name} in the archive leads out of it.`);
  return name;
}
