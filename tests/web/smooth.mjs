/**
 * How smoothly the page moves: a list of many renders that is scrolled and filtered, and a large image that is panned.
 * Environment: NOCTURNE_SMOOTH, JSON of url, renders (how many the list has), large (id of a render of 3840 x 2160).
 * Prints a line of JSON.
 */
import { launch, openPage } from "./browser.mjs";

const given = JSON.parse(process.env.NOCTURNE_SMOOTH);
const browser = await launch();
const { page } = await openPage(browser);

/** Times between frames in ms while `act` goes on in the page. */
async function framesDuring(act) {
  await page.evaluate(() => {
    globalThis.frames = [];
    globalThis.watching = true;
    let before = performance.now();
    const tick = (now) => {
      globalThis.frames.push(now - before);
      before = now;
      if (globalThis.watching) requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  });
  await act();
  const frames = await page.evaluate(() => { globalThis.watching = false; return globalThis.frames; });
  const sorted = frames.slice(2).sort((a, b) => a - b);
  const at = (part) => Math.round(10 * (sorted[Math.min(sorted.length - 1, Math.floor(part * sorted.length))] ?? 0)) / 10;
  return { frames: sorted.length, median_ms: at(0.5), p95_ms: at(0.95), longest_ms: at(1) };
}

async function loadList() {
  await page.goto(`${given.url}/#/`);
  const rows = page.locator(".renders li");
  await rows.first().waitFor();
  const more = page.getByRole("button", { name: "Show older renders" });
  while (await rows.count() < given.renders) {
    const before = await rows.count();
    await more.click();
    await page.waitForFunction((count) => document.querySelectorAll(".renders li").length > count, before);
  }
  return rows.count();
}

const rows = await loadList();
const scrolling = await framesDuring(async () => {
  await page.mouse.move(500, 400);
  for (let i = 0; i < 60; i += 1) {
    await page.mouse.wheel(0, i < 30 ? 600 : -600);
    await page.waitForTimeout(16);
  }
});
const filtering = await framesDuring(async () => {
  const filter = page.getByRole("searchbox", { name: "Filter" });
  await filter.pressSequentially("render 49", { delay: 60 });
  await filter.fill("");
  await page.waitForTimeout(300);
});
await page.goto(`${given.url}/#/renders/${given.large}`);
await page.locator("canvas[data-updates]").waitFor();
await page.locator('canvas[data-tiles="8160"]').waitFor();
const panning = await page.evaluate(async () => {
  const canvas = document.querySelector(".frame canvas");
  const send = (type, x) => canvas.dispatchEvent(new PointerEvent(type, { pointerId: 1, clientX: x, clientY: 300, bubbles: true }));
  canvas.setPointerCapture = () => undefined;
  const painted = () => Number(canvas.dataset.frames);
  const [first, start] = [painted(), performance.now()];
  send("pointerdown", 400);
  for (let step = 0; performance.now() - start < 3000; step += 1) {
    send("pointermove", 400 + 100 * Math.sin(step / 10));
    await new Promise(requestAnimationFrame);
  }
  send("pointerup", 400);
  return { images_per_s: Math.round((10_000 * (painted() - first)) / (performance.now() - start)) / 10 };
});
console.log(JSON.stringify({ rows, scrolling, filtering, panning }));
await browser.close();
