import js from "@eslint/js";
import { defineConfig } from "eslint/config";
import tseslint from "typescript-eslint";

export default defineConfig(
  { ignores: ["**/dist/", "**/node_modules/", "**/openapi.d.ts"] },
  js.configs.recommended,
  {
    files: ["**/*.ts", "**/*.mts"],
    extends: [tseslint.configs.strictTypeChecked, tseslint.configs.stylisticTypeChecked],
    languageOptions: {
      parserOptions: { project: "./tsconfig.json", tsconfigRootDir: import.meta.dirname },
    },
    rules: {
      // Numbers in template strings are plain text here.
      "@typescript-eslint/restrict-template-expressions": ["error", { allowNumber: true }],
      "max-lines": ["error", 200],
      "max-lines-per-function": ["error", 60],
      complexity: ["error", 10],
    },
  },
  {
    files: ["**/*.mjs"],
    languageOptions: {
      globals: Object.fromEntries(
        ["atob", "Blob", "Buffer", "console", "createImageBitmap", "DataTransfer", "document", "Element", "fetch", "File", "location", "MutationObserver", "navigator", "performance", "PointerEvent", "process", "requestAnimationFrame", "setTimeout", "URL"].map((name) => [name, "readonly"]),
      ),
    },
  },
  // A suite is one long describe block.
  { files: ["**/*.test.mts"], rules: { "@typescript-eslint/no-floating-promises": "off", "max-lines-per-function": "off" } },
);
