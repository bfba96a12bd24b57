/**
 * Writes src/service/openapi.d.ts: the types of docs/reference/openapi.json, with scenes typed by docs/reference/scene.schema.json.
 * `npm run check` makes it anew each time and it is never committed, so the page cannot be checked against old types.
 */
import { readFile, writeFile } from "node:fs/promises";
import openapiTS, { astToString } from "openapi-typescript";

const docs = new URL("../../docs/reference/", import.meta.url);
const readJson = async (name) => JSON.parse(await readFile(new URL(name, docs), "utf8"));

const description = await readJson("openapi.json");
const { $defs, ...scene } = JSON.parse(
  JSON.stringify(await readJson("scene.schema.json")).replaceAll("#/$defs/", "#/components/schemas/Scene."),
);
const { schemas } = description.components;
for (const [name, schema] of Object.entries($defs)) schemas[`Scene.${name}`] = schema;
schemas.SceneDocument = scene;

// Of what has a default, a request may leave it out.
const types = await openapiTS(description, { defaultNonNullable: false });
await writeFile(new URL("src/service/openapi.d.ts", import.meta.url), `/** Made by generate-types.mjs. */\n${astToString(types)}`);
