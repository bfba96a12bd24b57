/**
 * How soon the page shows a render that was submitted on it; or how smoothly it moves: a list of many renders that is scrolled and
 * filtered, and a large image that is panned. Environment: NOCTURNE_BENCH, JSON of url (workers there are idle), renders (how many the list
 * has), large (id of a render of 3840 x 2160), archive (a ZIP of a scene), rounds (how many are submitted;
 * 0: the page is moved).
 * Prints a line of JSON.
 */
import { launch, nextUpdates, openPage } from "./browser.mjs";

const given = JSON.parse(process.env.NOCTURNE_BENCH);
const browser = await launch();

/** Times between frames in ms while `act` goes on in the page. */
async function framesDuring(page, act) {
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

/** From Render to the first tile on the page, with a pilot and two layers; then how often the image changes. */
async function submit() {
  const { page, close } = await openPage(browser);
  await page.goto(`${given.url}/#/`);
  await page.getByLabel("choose a file").setInputFiles(given.archive);
  await page.getByLabel("Samples per pixel, at most").fill("100000");
  await page.getByLabel("Stop at a relative error of, %", { exact: true }).fill("0.1");
  await page.getByRole("checkbox", { name: "albedo" }).check();
  await page.getByRole("checkbox", { name: "depth" }).check();
  // As somebody who reads what the form says; the scene before has come to its end.
  await page.waitForTimeout(1000);
  const start = performance.now();
  await page.getByRole("button", { name: "Render", exact: true }).click();
  await page.locator("canvas[data-updates]").waitFor();
  const first = performance.now();
  await nextUpdates(page, 4);
  const last = performance.now();
  await page.getByRole("button", { name: "Cancel render…" }).click();
  await page.getByRole("dialog", { name: "Cancel this render?" }).getByRole("button", { name: "Cancel render" }).click();
  await page.locator('h1 .badge[data-state="CANCELLED"]').waitFor();
  await close();
  return { first_ms: Math.round(first - start), update_ms: Math.round((last - first) / 4) };
}

async function loadList(page) {
  await page.goto(`${given.url}/#/`);
  const rows = page.locator(".renders li");
  await rows.first().waitFor();
  const more = page.getByRole("button", { name: "Show older renders" });
  // Some come by events, so that a page may bring nothing new.
  while (await rows.count() < given.renders) {
    await Promise.all([page.waitForResponse(/page_token=./), more.click()]);
    await page.waitForTimeout(100);
  }
  return rows.count();
}

async function move() {
  const { page } = await openPage(browser);
  const rows = await loadList(page);
  const scrolling = await framesDuring(page, async () => {
    await page.mouse.move(500, 400);
    for (let i = 0; i < 60; i += 1) {
      await page.mouse.wheel(0, i < 30 ? 600 : -600);
      await page.waitForTimeout(16);
    }
  });
  const filtering = await framesDuring(page, async () => {
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
  return { rows, scrolling, filtering, panning };
}

async function submitOften() {
  const rounds = [];
  for (let round = 0; round < given.rounds; round += 1) rounds.push(await submit());
  return Object.fromEntries(Object.keys(rounds[0]).map((name) => [name, rounds.map((each) => each[name])]));
}

console.log(JSON.stringify(given.rounds > 0 ? await submitOften() : await move()));
await browser.close();
