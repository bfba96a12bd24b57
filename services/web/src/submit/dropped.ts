/** Files that people drop or choose: a folder, an archive, or single files, by path. */
import { mostFiles, readZip } from "./zip.ts";

/** Throws Error, fit to be shown. */
export async function filesOf(list: Iterable<File>): Promise<Map<string, Blob>> {
  const files = [...list];
  const only = files.length === 1 ? files[0] : undefined;
  if (only?.name.toLowerCase().endsWith(".zip")) return readZip(only);
  return new Map(files.map((file) => [file.webkitRelativePath || file.name, file]));
}

/** What was dropped; folders are walked through. Entries must be taken before anything is waited for. */
export async function filesDropped(data: DataTransfer): Promise<Map<string, Blob>> {
  const entries = [...data.items].map((item) => item.webkitGetAsEntry()).filter((entry) => entry !== null);
  if (!entries.some((entry) => entry.isDirectory)) return filesOf(data.files);
  const found = new Map<string, Blob>();
  for (const entry of entries) await walk(entry, found);
  return found;
}

async function walk(entry: FileSystemEntry, found: Map<string, Blob>): Promise<void> {
  if (found.size >= mostFiles) throw new Error(`The folder has more than ${mostFiles} files.`);
  if (entry.isFile) {
    const file = await new Promise<File>((resolve, reject) => { (entry as FileSystemFileEntry).file(resolve, reject); });
    found.set(entry.fullPath.slice(1), file);
    return;
  }
  const reader = (entry as FileSystemDirectoryEntry).createReader();
  const next = (): Promise<FileSystemEntry[]> => new Promise((resolve, reject) => { reader.readEntries(resolve, reject); });
  for (let batch = await next(); batch.length > 0; batch = await next()) for (const inner of batch) await walk(inner, found);
}
