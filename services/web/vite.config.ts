import { defineConfig } from "vite";

// The address of a running `nocturne up`, for `npm run dev`.
const service = process.env.NOCTURNE_URL ?? "http://127.0.0.1:7070";

export default defineConfig({
  build: {
    target: "es2023",
    // The content security policy allows "self" only: no data: addresses, no inline script.
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
  },
  server: { proxy: { "/v1": service } },
});
