/**
 * Pictures of the page for docs/images/page, of renders worth looking at. Environment: NOCTURNE_PICTURES, JSON of
 *   url: a service; shown, other: ids of renders of one scene and film; group: a name; folder: where they go.
 */
import { desktop, launch, openPage, phone, savePicture } from "./browser.mjs";

const given = JSON.parse(process.env.NOCTURNE_PICTURES);
const wide = { width: 1200, height: 800 };

/** The view that is there, at its usual width, and elsewhere if wanted. */
async function keep(page, name, looks = ["light"]) {
  for (const look of looks) {
    await page.emulateMedia({ colorScheme: look === "light" ? "light" : "dark" });
    await page.setViewportSize(look === "phone" ? phone : wide);
    // Charts follow the width.
    await page.waitForTimeout(800);
    await savePicture(page, `${name}-${look}`, given.folder);
  }
  await page.emulateMedia({ colorScheme: "light" });
  await page.setViewportSize(desktop);
}

const views = {
  async render(page) {
    await page.goto(`${given.url}/#/renders/${given.shown}?view=luminance`);
    await page.locator("canvas[data-updates]").waitFor();
    await page.locator("figure:not([data-points='0']) .uplot").waitFor();
    await page.getByRole("region", { name: "Pixel" }).waitFor();
    await page.locator(".frame canvas[tabindex]").focus();
    await page.keyboard.press("ArrowLeft");
    await keep(page, "render", ["light", "dark", "phone"]);
  },
  async measure(page) {
    await page.goto(`${given.url}/#/renders/${given.shown}?view=luminance`);
    await page.locator("canvas[data-updates]").waitFor();
    await page.getByText("Measure", { exact: true }).click();
    for (const [kind, points, name] of [["Line", "60,330 340,330", "floor"], ["Polygon", "60,80 190,80 125,260", "wall"], ["Region", "140,20 260,60", "ceiling"]]) {
      await page.getByRole("combobox", { name: "Part" }).selectOption(kind);
      await page.getByLabel("Points in pixels").fill(points);
      await page.getByLabel("Name of the part").fill(name);
      await page.keyboard.press("Enter");
      await page.locator(".measure tbody tr").filter({ hasText: name }).waitFor();
    }
    await page.getByRole("checkbox", { name: "Isolines" }).check();
    await page.waitForResponse((response) => response.url().includes("/isolines"));
    await page.locator(".measure .uplot").waitFor();
    await keep(page, "measure");
  },
  async denoised(page) {
    await page.goto(`${given.url}/#/renders/${given.other}`);
    await page.locator("canvas[data-updates]").waitFor();
    await page.getByRole("button", { name: "Show a denoised picture" }).click();
    await page.getByRole("img", { name: "Where they differ" }).evaluate((image) => image.decode());
    await keep(page, "denoised");
  },
  async compare(page) {
    await page.goto(`${given.url}/#/compare/${given.shown}/${given.other}?wipe=0.5`);
    await page.locator("canvas[data-updates]").waitFor();
    await page.locator(".plot .uplot").waitFor();
    await keep(page, "compare");
  },
  async list(page) {
    await page.goto(`${given.url}/#/`);
    await page.locator(".thumbnail.loaded").nth(4).waitFor();
    await keep(page, "list");
  },
  async group(page) {
    await page.goto(`${given.url}/#/groups/${encodeURIComponent(given.group)}`);
    await page.getByText(/renders have ended/).waitFor();
    await page.locator(".thumbnail.loaded").first().waitFor();
    await keep(page, "group");
  },
  async workers(page) {
    await page.goto(`${given.url}/#/workers`);
    await page.locator(".workers tbody tr").first().waitFor();
    await page.locator(".plot .uplot").waitFor();
    await keep(page, "workers");
  },
  async speed(page) {
    await page.goto(`${given.url}/#/speed`);
    await page.locator(".plot .uplot").waitFor();
    await keep(page, "speed");
  },
};

const browser = await launch();
try {
  const { page } = await openPage(browser);
  for (const show of Object.values(views)) await show(page);
} finally {
  await browser.close();
}
