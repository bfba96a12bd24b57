/**
 * What the page promises about time, in a browser on a machine that does nothing else: `make page-times`. Environment: NOCTURNE_E2E, JSON of
 *   url: a service whose workers are idle; large: id of a render of 3840 x 2160 that has ended; archive: a ZIP of the Cornell box.
 * Prints what was measured; exit code 1 where a promise is not kept.
 */
import assert from "node:assert/strict";
import { launch, nextUpdates, openPage } from "./browser.mjs";

const given = JSON.parse(process.env.NOCTURNE_E2E);

const promises = {
  /** From Render to the first tiles on the page, with a pilot and two layers before the first sample; then how often it changes. */
  async "the first tile is there soon, and others follow each second"(page) {
    await page.goto(`${given.url}/#/`);
    await page.getByLabel("choose a file").setInputFiles(given.archive);
    await page.getByLabel("Samples per pixel, at most").fill("100000");
    await page.getByLabel("Stop at a relative error of, %").fill("0.1");
    await page.getByRole("checkbox", { name: "albedo" }).check();
    await page.getByRole("checkbox", { name: "depth" }).check();
    const start = Date.now();
    await page.getByRole("button", { name: "Render", exact: true }).click();
    await page.locator("canvas[data-updates]").waitFor();
    const first = Date.now() - start;
    const since = Date.now();
    await nextUpdates(page, 4);
    const each = (Date.now() - since) / 4;
    await page.getByRole("button", { name: "Cancel render…" }).click();
    await page.getByRole("dialog", { name: "Cancel this render?" }).getByRole("button", { name: "Cancel render" }).click();
    await page.locator('h1 .badge[data-state="CANCELLED"]').waitFor();
    console.log(`first tiles on the page after ${first} ms, then every ${Math.round(each)} ms`);
    // Without pilot and layers it is 1.2 s; with them 2.4 s on an idle machine of two processors.
    assert.ok(first < 4000 && each <= 1000);
  },

  async "an image of 3840 x 2160 pans smoothly"(page) {
    await page.goto(`${given.url}/#/renders/${encodeURIComponent(given.large)}`);
    await page.locator('canvas[data-tiles="8160"]').waitFor();
    // Whatever else the machine does only slows it, so the best of three tries counts.
    const rates = [];
    for (let tries = 0; tries < 3; tries += 1) rates.push(await page.evaluate(framesWhilePanning));
    const rate = Math.max(...rates);
    console.log(`${rate.toFixed(0)} frames a second at 3840 x 2160, painted by the processor`);
    assert.ok(rate >= 30);
  },
};

/** Inside the page: frames a second while the image is dragged for a second and a half. */
async function framesWhilePanning() {
  const canvas = document.querySelector(".frame canvas");
  const send = (type, x) => canvas.dispatchEvent(new PointerEvent(type, { pointerId: 1, clientX: x, clientY: 300, bubbles: true }));
  canvas.setPointerCapture = () => undefined;
  const painted = () => Number(canvas.dataset.frames);
  const [first, start] = [painted(), performance.now()];
  send("pointerdown", 400);
  for (let step = 0; performance.now() - start < 1500; step += 1) {
    send("pointermove", 400 + 100 * Math.sin(step / 10));
    await new Promise(requestAnimationFrame);
  }
  send("pointerup", 400);
  return (1000 * (painted() - first)) / (performance.now() - start);
}

const browser = await launch();
try {
  const { page } = await openPage(browser);
  for (const [name, holds] of Object.entries(promises)) {
    try {
      await holds(page);
    } catch (error) {
      console.log(`failed: ${name}`);
      throw error;
    }
  }
} finally {
  await browser.close();
}
