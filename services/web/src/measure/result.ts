/** What a report says of a room's light, as the service tells it. Pure. */

export interface Words {
  requirement: string;
  /** Of all limits together; empty where nothing was asked for or measured. */
  verdict: "holds" | "fails" | "open" | "";
  says: string;
  warnings: string[];
  checks: { what: string; limit: string; found: string; says: string; verdict: "holds" | "fails" | "open" | "" }[];
  sections: { title: string; tables: { head: string[]; rows: string[][] }[] }[];
}

/** Requirements that the page offers by name; others are limits. */
export const requirements = [
  { name: "No requirement", value: "" },
  { name: "EN 12464-1, 34.1 filing, copying", value: "EN 12464-1:34.1" },
  { name: "EN 12464-1, 34.2 writing, typing, reading", value: "EN 12464-1:34.2" },
  { name: "EN 12464-1, 34.3 technical drawing", value: "EN 12464-1:34.3" },
  { name: "EN 12464-1, 34.4 CAD workstations", value: "EN 12464-1:34.4" },
  { name: "EN 12464-1, 34.5 conference rooms", value: "EN 12464-1:34.5" },
  { name: "EN 12464-1, 34.6 reception desk", value: "EN 12464-1:34.6" },
  { name: "EN 12464-1, 34.7 archives", value: "EN 12464-1:34.7" },
  { name: "Limits by hand", value: "limits" },
] as const;

const words = { holds: "Holds", fails: "Does not hold", open: "Open" };

/** The verdict in the first place: a word that stands alone, and its sentence. */
export function leadOf({ verdict, says }: Pick<Words, "verdict" | "says">): { word: string; sentence: string } {
  return { word: verdict ? words[verdict] : "", sentence: says };
}

/** Whether the service can report on it: it measures illuminance at known places, and no coefficients. */
export function isOfRoom({ sensor, quantity }: { sensor: string; quantity: string }): boolean {
  return (sensor === "meters" || sensor === "irradiance_meter") && quantity === "illuminance";
}

/** The first table of readings, with E_m and U0. */
export function readingsOf({ sections }: Pick<Words, "sections">): { title: string; head: string[]; rows: string[][] }[] {
  return sections
    .filter(({ title, tables }) => title.startsWith("Illuminance") || (title === "Points" && tables.length > 0))
    .flatMap(({ title, tables }) => tables.slice(0, 1).map((table) => ({ title, ...table })));
}
