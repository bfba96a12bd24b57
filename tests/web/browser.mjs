/** Debian's Chromium, driven by the playwright-core that the page's lock file names. */
import { createRequire } from "node:module";

const require = createRequire(new URL("../../services/web/package.json", import.meta.url));
const { chromium } = require("playwright-core");

export const axeSource = require("axe-core").source;

export const desktop = { width: 1000, height: 700 };
export const phone = { width: 390, height: 844 };

export function launch() {
  return chromium.launch({
    executablePath: process.env.NOCTURNE_CHROMIUM ?? "/usr/bin/chromium",
    args: [
      "--no-sandbox",
      "--disable-gpu",
      "--disable-quic",
      "--no-first-run",
      "--disable-background-networking",
      "--disable-component-update",
      "--disable-sync",
    ],
  });
}

/** A page that notes what went wrong in `faults`: exceptions and refusals by the content security policy. */
export async function openPage(browser) {
  const context = await browser.newContext({ viewport: desktop });
  const page = await context.newPage();
  const faults = [];
  page.on("pageerror", (error) => faults.push(error.message));
  page.on("console", (message) => {
    if (message.type() === "error" && /security policy/i.test(message.text())) faults.push(message.text());
  });
  return { page, faults, close: () => context.close() };
}

/** Mean and spread of the canvas's colour values, 0 to 255. */
export function canvasStatistics(page) {
  return page.evaluate(() => {
    const canvas = document.querySelector("canvas[role=img]");
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    const values = data.filter((_, index) => index % 4 !== 3);
    const mean = values.reduce((sum, value) => sum + value, 0) / values.length;
    const variance = values.reduce((sum, value) => sum + (value - mean) ** 2, 0) / values.length;
    return { mean, spread: Math.sqrt(variance), width: canvas.width, height: canvas.height };
  });
}
