import { fileURLToPath } from "node:url";
import { defineConfig } from "vite";

// The address of a running `nocturne up`, for `npm run dev`.
const service = process.env.NOCTURNE_URL ?? "http://127.0.0.1:7070";

const file = (name: string): string => fileURLToPath(new URL(name, import.meta.url));

export default defineConfig({
  build: {
    target: "es2023",
    // The content security policy allows "self" only: no data: addresses, no inline script.
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    // Swagger UI, which only the API reference loads, is 1.5 MB.
    chunkSizeWarningLimit: 2000,
    rolldownOptions: { input: [file("index.html"), file("reference.html")] },
  },
  server: { proxy: { "/v1": service, "/openapi.json": service } },
});
