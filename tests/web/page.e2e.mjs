/**
 * The page in a browser, against a running service with workers and two submitted renders.
 * Environment: NOCTURNE_URL; NOCTURNE_RENDER, id of a render 128 x 128, 64 samples; NOCTURNE_LONG_RENDER, id of one that takes
 * minutes and will be cancelled; NOCTURNE_SCREENSHOTS, a folder.
 * Prints a line per check; exit code 1 at the first that fails.
 */
import assert from "node:assert/strict";
import { mkdirSync } from "node:fs";
import { join } from "node:path";
import { breakableProxy } from "./breakable_proxy.mjs";
import { axeSource, canvasStatistics, desktop, launch, openPage, phone } from "./browser.mjs";

const service = required("NOCTURNE_URL");
const render = required("NOCTURNE_RENDER");
const longRender = required("NOCTURNE_LONG_RENDER");
const screenshots = required("NOCTURNE_SCREENSHOTS");
mkdirSync(screenshots, { recursive: true });

const renderHash = `#/renders/${encodeURIComponent(render)}`;
const ended_ms = 60_000;

/** In the order of a visit; each gets the page as the one before left it. */
const checks = {
  async "the list shows the render, with state and samples"({ page, url }) {
    await page.goto(`${url}/`);
    const row = page.getByRole("listitem").filter({ has: page.locator(`a[href="${renderHash}"]`) });
    await row.waitFor();
    await row.getByText(/Queued|Running|Succeeded/).waitFor();
    await row.getByText(/128 × 128 · .* samples/).waitFor();
    await row.getByRole("progressbar").waitFor();
  },

  async "the keyboard opens the render"({ page }) {
    const link = page.locator(`a[href="${renderHash}"]`);
    await link.focus();
    await page.keyboard.press("Enter");
    await page.waitForURL(`**/${renderHash}`);
    assert.equal(await page.evaluate(() => document.activeElement?.tagName), "H1", "focus moves to the new page's heading");
  },

  async "the image appears on the canvas"({ page }) {
    await page.locator("canvas[data-previews]").waitFor({ timeout: ended_ms });
    const { width, height, spread } = await canvasStatistics(page);
    assert.deepEqual([width, height], [128, 128]);
    assert.ok(spread > 5, `the canvas is blank: standard deviation ${spread}`);
  },

  async "a worker is in the table"({ page }) {
    const row = page.locator(".workers tbody tr").first();
    await row.waitFor();
    const [threads, , jobs] = await row.locator("td").allTextContents();
    assert.ok(Number(threads) >= 1, `threads: ${threads}`);
    assert.notEqual(jobs, "");
  },

  async "the state becomes Succeeded, without a reload"({ page }) {
    await page.locator('h1 .badge[data-state="SUCCEEDED"]').waitFor({ timeout: ended_ms });
    const bar = page.locator("aside progress");
    assert.equal(await bar.evaluate((node) => node.value), 1);
    await page.getByText("64 of 64").waitFor();
    assert.equal(await page.getByRole("button", { name: "Cancel render" }).isVisible(), false);
  },

  async "the chart has points, on both axes"({ page }) {
    await page.locator("figure:not([data-points='0']) .uplot").waitFor();
    await page.getByLabel("Photons").check();
    await page.locator(".u-legend").getByText("Photons").waitFor();
    assert.ok(Number(await page.locator("figure").getAttribute("data-points")) >= 1);
  },

  async "the exposure slider brightens, by keyboard, and resets"({ page }) {
    const before = await canvasStatistics(page);
    const slider = page.getByRole("slider", { name: "Exposure" });
    await slider.focus();
    for (let step = 0; step < 10; step += 1) await page.keyboard.press("ArrowRight");
    await page.getByText("+1.0 EV").waitFor();
    const brighter = await canvasStatistics(page);
    assert.ok(brighter.mean > before.mean + 5, `mean ${before.mean} became ${brighter.mean}`);
    await page.getByRole("button", { name: "Reset exposure" }).click();
    assert.equal((await canvasStatistics(page)).mean, before.mean);
  },

  async "both images can be downloaded"({ page, url }) {
    for (const [name, magic] of [["Download EXR", [0x76, 0x2f, 0x31, 0x01]], ["Download PNG", [0x89, 0x50, 0x4e, 0x47]]]) {
      const address = await page.getByRole("link", { name }).getAttribute("href");
      const response = await fetch(new URL(address, url));
      assert.equal(response.status, 200, `${name}: ${address}`);
      assert.deepEqual([...new Uint8Array(await response.arrayBuffer()).subarray(0, 4)], magic, name);
    }
  },

  async "the image of a running render changes by itself"({ page, url }) {
    await page.goto(`${url}/#/renders/${encodeURIComponent(longRender)}`);
    await nextPreviews(page, 1);
    const before = await canvasStatistics(page);
    await nextPreviews(page, 2);
    assert.notEqual((await canvasStatistics(page)).mean, before.mean);
  },

  async "a lost connection is shown, and the image goes on after it"({ page, proxy }) {
    const bar = page.locator("#connection");
    await bar.getByText("Live").waitFor();
    await proxy.cut();
    await bar.getByText("reconnecting").waitFor();
    await page.screenshot({ path: join(screenshots, "reconnecting.png") });
    await proxy.mend();
    await bar.getByText("Live").waitFor();
    await nextPreviews(page, 1);
  },

  async "cancel asks first, and then cancels"({ page }) {
    await page.getByRole("button", { name: "Cancel render…" }).click();
    const dialog = page.getByRole("dialog", { name: "Cancel this render?" });
    await dialog.getByRole("button", { name: "Keep rendering" }).click();
    await dialog.waitFor({ state: "hidden" });
    await page.locator('h1 .badge[data-state="RUNNING"]').waitFor();
    await page.getByRole("button", { name: "Cancel render…" }).click();
    await dialog.getByRole("button", { name: "Cancel render" }).click();
    await page.locator('h1 .badge[data-state="CANCELLED"]').waitFor();
  },

  async "a render that does not exist is explained"({ page, url }) {
    await page.goto(`${url}/#/renders/no-such-render`);
    await page.getByRole("alert").getByText("cannot be shown").waitFor();
  },
};

/** Waits until the canvas has been painted `count` more times; 0 so far where it has never been. */
async function nextPreviews(page, count) {
  const painted = () => page.evaluate(() => Number(document.querySelector("canvas[role=img]")?.dataset.previews ?? 0));
  const goal = (await painted()) + count;
  const deadline = Date.now() + ended_ms;
  while ((await painted()) < goal) {
    assert.ok(Date.now() < deadline, `the image was not painted ${count} more times within ${ended_ms} ms`);
    await new Promise((resolve) => setTimeout(resolve, 100));
  }
}

const places = [
  { name: "list", hash: "#/", ready: ".thumbnail.loaded" },
  { name: "render", hash: renderHash, ready: "canvas[data-previews]" },
];

const looks = [
  { name: "light", colorScheme: "light", viewport: desktop, audited: true },
  { name: "dark", colorScheme: "dark", viewport: desktop, audited: true },
  { name: "phone", colorScheme: "dark", viewport: phone },
];

/** Looks right to a machine: nothing wider than the window, no serious fault that axe knows. */
async function checkLooks(browser, place) {
  const { page, faults, close } = await openPage(browser);
  await page.goto(`${service}/${place.hash}`);
  await page.locator(place.ready).first().waitFor();
  await page.locator(".workers table").waitFor();
  for (const look of looks) {
    await page.emulateMedia({ colorScheme: look.colorScheme });
    await page.setViewportSize(look.viewport);
    await page.screenshot({ path: join(screenshots, `${place.name}-${look.name}.png`), fullPage: true });
    const excess = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
    assert.equal(excess, 0, `${place.name} is ${excess} px wider than the window: ${look.name}`);
    if (look.audited) assert.deepEqual(await accessibilityFaults(page), [], look.name);
  }
  assert.deepEqual(faults, []);
  await close();
}

async function accessibilityFaults(page) {
  await page.evaluate(axeSource);
  const { violations } = await page.evaluate("axe.run()");
  return violations
    .filter(({ impact }) => impact === "serious" || impact === "critical")
    .map(({ id, nodes }) => `${id}: ${nodes.map(({ html }) => html).join(", ")}`);
}

function required(name) {
  const value = process.env[name];
  if (!value) throw new Error(`${name} is not set; see the head of this file`);
  return value;
}

async function step(name, action) {
  const start = Date.now();
  await action();
  console.log(`ok  ${name} (${Date.now() - start} ms)`);
}

const browser = await launch();
const proxy = await breakableProxy(service);
try {
  const { page, faults } = await openPage(browser);
  page.setDefaultTimeout(10_000);
  for (const [name, check] of Object.entries(checks)) await step(name, () => check({ page, proxy, url: proxy.url }));
  assert.deepEqual(faults, []);
  for (const place of places) await step(`looks of the ${place.name}`, () => checkLooks(browser, place));
} finally {
  await browser.close();
  await proxy.close();
}
