/**
 * The page in a browser, against a running service with workers. Environment: NOCTURNE_E2E, JSON of
 *   url, api_pid: the service; auth_url, token: another API on the same data that asks for tokens;
 *   small, other: ids of renders 128 x 128 of the Cornell box that have ended; `other` is by another engine;
 *   panorama: a render of a bright sky, as an eye has it around;
 *   guided: a render of a pool from above, whose photons are guided;
 *   unmet: a render whose left upper quarter may lack light, by what it says;
 *   quarantine: a command that puts the worker named after it in quarantine;
 *   exr: the image of `small`; pixel: {x, y, values} of it, read by OpenImageIO; archive, scene_folder: a ZIP of the Cornell box, its folder;
 *   screenshots: a folder; empty: no pictures are kept;
 *   brief: without the checks of `onlyWhenWhole`, and without asking that every control was used.
 * Prints a line per check; exit code 1 at the first that fails.
 * One file, though long: a visit, in which each check goes on from the page as the one before left it.
 */
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { canvasStatistics, checkLooks, choose, chooseFiles, launch, nextUpdates, noteControls, openPage, type, until } from "./browser.mjs";

const given = JSON.parse(process.env.NOCTURNE_E2E);
const at = (hash) => `${given.url}/${hash}`;
const showing = (id) => `#/renders/${encodeURIComponent(id)}`;
/** The page may have added what is looked at by then. */
const comparing = (page) => page.waitForURL((url) => url.hash.split("?")[0] === `#/compare/${given.small}/${given.other}`);
const look = (page, name) => checkLooks(page, name, given.screenshots);

/** White fog and a white ball in even light: by theory nobody sees them, and all collisions are in vain. */
const evenLight = {
  nocturne: 1,
  media: { fog: { scattering: 3 } },
  sensor: { type: "orthographic", position: [0, 0, 4], look_at: [0, 0, 0], height: 1 },
  environment: { radiance: 1 },
  surfaces: [
    { shape: { type: "box", minimum: [-1, -1, -1], maximum: [1, 1, 1] }, interior: { media: ["fog"] } },
    { shape: { type: "sphere", centre: [0, 0, -3], radius: 1 }, kernel: { type: "lambertian", reflectance: 1 } },
  ],
};

/** In the order of a visit; each gets the page as the one before left it. */
const checks = {
  async "the list shows renders, and finds them by word and state"({ page }) {
    await page.goto(at("#/"));
    const rows = page.locator(".renders li");
    const row = rows.filter({ has: page.locator(`a[href="${showing(given.small)}"]`) });
    await row.getByText("Succeeded").waitFor();
    await row.getByText(/128 × 128 · 64 \/ 64 samples/).waitFor();
    await row.locator(".thumbnail.loaded").waitFor();
    await row.getByText(/CPU/).waitFor();
    await page.getByRole("searchbox", { name: "Filter" }).fill("no such name");
    await page.getByText("No render is like that.").waitFor();
    await page.getByRole("searchbox", { name: "Filter" }).fill("");
    await page.getByRole("combobox", { name: "Show" }).selectOption("Ended");
    await choose(page.getByRole("combobox", { name: "Order" }), "Largest error first");
    await page.waitForURL("**/#/?show=ended&order=error");
    await page.reload();
    await row.waitFor();
    assert.equal(await page.getByRole("combobox", { name: "Order" }).inputValue(), "error");
    // Four times the samples, half the error.
    const ids = await rows.locator("a.name").evaluateAll((links) => links.map((link) => link.getAttribute("href")));
    assert.ok(ids.indexOf(showing(given.other)) < ids.indexOf(showing(given.small)), ids.join());
    await page.getByRole("combobox", { name: "Order" }).selectOption("Newest first");
    await page.getByRole("combobox", { name: "Show" }).selectOption("All states");
    await page.waitForURL("**/#/");
  },

  async "a denoised picture stands beside the true image, or the service says that it has none"({ page, note }) {
    await page.goto(at(showing(given.small)));
    const button = page.getByRole("button", { name: "Show a denoised picture" });
    await button.focus();
    await page.keyboard.press("Enter");
    const shown = page.getByRole("img", { name: "Denoised, to look at" });
    const lacking = page.getByText(/has no denoiser/);
    await shown.or(lacking).waitFor({ timeout: 60_000 });
    const made = await shown.isVisible();
    note(made ? "the denoiser is there" : "there is no denoiser here");
    if (made) {
      await page.getByRole("img", { name: "Where they differ" }).evaluate((image) => image.decode());
      await page.getByRole("link", { name: "Denoised EXR" }).waitFor();
    }
    await look(page, "denoised");
    await page.goto(at("#/"));
  },

  async "a group is shown as one, by the link of its renders"({ page }) {
    const rows = page.locator(".renders li");
    await rows.first().getByRole("link", { name: "group boxes" }).or(rows.nth(1).getByRole("link", { name: "group boxes" })).first().focus();
    await page.keyboard.press("Enter");
    await page.getByRole("heading", { name: "Group boxes" }).waitFor();
    await page.getByText(/^2 of 2 renders have ended, 100.0 % is done/).waitFor();
    while ((await rows.count()) !== 2) await page.waitForTimeout(50);
    await look(page, "group");
    await page.getByRole("link", { name: "← All renders" }).click();
    await page.getByRole("heading", { name: "Renders", exact: true }).waitFor();
  },

  async "the keyboard opens a render"({ page }) {
    const link = page.locator(`a[href="${showing(given.small)}"]`);
    await link.focus();
    await page.keyboard.press("Enter");
    await page.waitForURL(`**/${showing(given.small)}`);
    // Screen readers start at the new page's heading.
    await page.locator("h1:focus").waitFor();
    await page.locator("canvas[data-updates]").waitFor();
    const { spread } = await canvasStatistics(page);
    assert.ok(spread > 5, `the canvas is blank: standard deviation ${spread}`);
  },

  async "a pixel has the EXR's values, by mouse and by keyboard"({ page }) {
    const { x, y, values } = given.pixel;
    const canvas = page.locator(".frame canvas[tabindex]");
    const box = await canvas.boundingBox();
    const scale = await page.locator(".zoom").textContent().then((text) => parseFloat(text) / 100);
    await page.mouse.move(box.x + box.width / 2 + (x + 0.5 - 64) * scale, box.y + box.height / 2 + (y + 0.5 - 64) * scale);
    const pixel = page.getByRole("region", { name: "Pixel" });
    await pixel.getByText(`${x}, ${y}`, { exact: true }).waitFor();
    const shown = async (label) => (await pixel.locator(`dl > div:has(dt:text-is("${label}")) dd`).textContent()).replaceAll("\u00a0", " ");
    const xyz = (await shown("X Y Z")).split("  ").map(parseFloat);
    values.slice(0, 3).forEach((value, i) => assert.ok(Math.abs(xyz[i] / value - 1) < 1e-4, `${xyz} is not ${values}`));
    const half = Number(/± (\S+)/.exec(await shown("95\u00a0%"))[1]);
    assert.ok(Math.abs(half / (1.96 * values[3]) - 1) < 1e-2, `${half} is not of ${values[3]}`);
    assert.equal(await shown("Samples"), "64");
    // The service tells the errors of the other quantities.
    await pixel.getByText(/\S+\u00a0±\u00a0\S+ {2}\S+\u00a0±\u00a0\S+ {2}\S+\u00a0±\u00a0\S+/).waitFor();
    assert.match(await shown("u\u2032 v\u2032"), /^0\.\d{4} ± \S+ {2}0\.\d{4} ± \S+$/);
    await canvas.focus();
    await page.keyboard.press("ArrowLeft");
    await pixel.getByText("63, 64", { exact: true }).waitFor();
  },

  async "of a guided render a map shows where light was learned to come from"({ page }) {
    await page.goto(at(showing(given.guided)));
    await page.locator("canvas[data-updates]").waitFor();
    await page.getByText("Learned light").focus();
    await page.keyboard.press("Enter");
    await page.locator(".frame canvas[tabindex]").focus();
    await page.keyboard.press("ArrowLeft");
    await page.getByText(/seen by 1 mirror or boundary: \d+ cones/).waitFor({ timeout: 60_000 });
    const cones = page.getByRole("img", { name: "Directions that light was learned to come from" }).locator("polygon");
    assert.ok((await cones.count()) >= 8);
    await look(page, "learned-light");
    await page.goto(at(showing(given.small)));
    await page.locator("canvas[data-updates]").waitFor();
    assert.ok(await page.getByText("Learned light").isHidden());
  },

  async "parts in which light may be missing are hatched, until a switch takes that back"({ page }) {
    const hatched = (x, y) => page.locator("canvas.overlay").evaluate((canvas, [across, down]) => {
      const { width, height } = canvas;
      const edge = Math.min(width, height) / 4;
      // The film is square, in the middle; an eighth of it around a point, so that some line crosses that.
      const at = (part, whole) => Math.round(whole / 2 + (part - 0.5) * 2 * edge - edge / 8);
      return canvas.getContext("2d").getImageData(at(across, width), at(down, height), edge / 4, edge / 4).data.some((value) => value > 0);
    }, [x, y]);
    await page.goto(at(showing(given.unmet)));
    await page.locator("canvas[data-updates]").waitFor();
    await page.getByRole("list", { name: "Warnings" }).getByText(/^reflections, refractions or caustics/).waitFor();
    await page.getByText("Hatched, 25 % of the image: light of small bright sources may be missing there").waitFor();
    await until(page, "the quarter is hatched", () => hatched(0.25, 0.25));
    assert.equal(await hatched(0.75, 0.75), false);
    await look(page, "doubtful-parts");
    await page.getByRole("checkbox", { name: "Doubtful parts" }).focus();
    await page.keyboard.press("Space");
    await until(page, "nothing is hatched", async () => !(await hatched(0.25, 0.25)));
    await page.keyboard.press("Space");
    await page.goto(at(showing(given.small)));
    await page.locator("canvas[data-updates]").waitFor();
    assert.ok(await page.getByRole("checkbox", { name: "Doubtful parts" }).isHidden());
  },

  async "keys and buttons zoom, until values stand on pixels; the address keeps where"({ page }) {
    const zoom = () => page.locator(".zoom").textContent().then(parseFloat);
    const valuesOnPixels = () => page.locator("canvas.overlay").evaluate((canvas) => canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data.some((value) => value > 0));
    const pressed = async (name) => {
      await page.getByRole("button", { name, exact: true }).focus();
      await page.keyboard.press("Enter");
    };
    const fitted = await zoom();
    await pressed("Zoom in");
    assert.equal(await zoom(), 2 * fitted);
    await pressed("Zoom out");
    assert.equal(await zoom(), fitted);
    await pressed("1:1");
    assert.equal(await zoom(), 100);
    await page.locator(".frame canvas[tabindex]").focus();
    for (let step = 0; step < 12; step += 1) await page.keyboard.press("+");
    await page.keyboard.press("Shift+ArrowLeft");
    await until(page, "values stand on pixels", valuesOnPixels);
    const large = await zoom();
    // The address follows at most three times a second.
    const remembered = () => 100 * Number(/[?&]at=[^&]*(?:,|%2C)([\d.]+)/.exec(page.url())?.[1]);
    await until(page, "the address has the zoom", async () => Math.round(remembered()) === Math.round(large));
    await page.reload();
    await page.locator("canvas[data-updates]").waitFor();
    assert.equal(await zoom(), large);
    await until(page, "values stand on pixels", valuesOnPixels);
    await pressed("Fit");
    assert.equal(await zoom(), fitted);
    await until(page, "no values are left", async () => !(await valuesOnPixels()));
    for (const name of ["Clipping", "Gamut"]) {
      const before = await canvasStatistics(page);
      await page.getByRole("slider", { name: "Exposure" }).fill("6");
      await page.getByRole("checkbox", { name }).focus();
      const bright = await canvasStatistics(page);
      assert.ok(bright.mean > before.mean);
      await page.keyboard.press("Space");
      assert.equal(await page.getByRole("checkbox", { name }).isChecked(), true);
      if (name === "Clipping") assert.notEqual((await canvasStatistics(page)).mean, bright.mean);
      await page.keyboard.press("Space");
      await pressed("Auto");
    }
  },

  async "the image takes the window's width, and by a key the whole screen"({ page }) {
    const size = page.viewportSize();
    await page.setViewportSize({ width: 1900, height: 900 });
    const frame = page.locator(".frame").first();
    assert.ok((await frame.boundingBox()).width > 1450);
    const button = page.getByRole("button", { name: "Full screen" });
    await button.focus();
    await page.keyboard.press("Enter");
    await until(page, "the image fills the screen", () => page.evaluate(() => document.fullscreenElement?.matches(".picture") ?? false));
    await until(page, "the button is pressed", async () => (await button.getAttribute("aria-pressed")) === "true");
    assert.ok((await frame.boundingBox()).width > 1800);
    assert.ok((await frame.boundingBox()).height >= 530);
    await page.keyboard.press("Enter");
    await until(page, "it is a page again", () => page.evaluate(() => document.fullscreenElement === null));
    await until(page, "the button is no more pressed", async () => (await button.getAttribute("aria-pressed")) === "false");
    await page.setViewportSize(size);
  },

  async "a region, a line and a polygon are drawn by keys, a polygon by clicks"({ page }) {
    const canvas = page.locator(".frame canvas[tabindex]");
    const draw = async (name, keys) => {
      const button = page.getByRole("button", { name, exact: true });
      await button.focus();
      await page.keyboard.press("Enter");
      assert.equal(await button.getAttribute("aria-pressed"), "true");
      await canvas.focus();
      for (const key of keys) await page.keyboard.press(key);
      await button.focus();
      await page.keyboard.press("Enter");
    };
    const region = page.getByRole("region", { name: "Region" });
    await draw("Region", ["Enter", "ArrowRight", "ArrowRight", "ArrowDown", "Enter", "ArrowDown"]);
    await region.getByText(/^\d+, 64, 3 × 2$/).waitFor();
    await page.getByText("Measure", { exact: true }).click();
    const points = page.getByLabel("Points in pixels");
    await draw("Line", ["Enter", "ArrowRight", "ArrowRight", "Enter"]);
    assert.match(await points.inputValue(), /^\d+,\d+ \d+,\d+$/);
    await draw("Polygon", ["Enter", "ArrowRight", "ArrowRight", "Enter", "ArrowDown", "ArrowDown", "Enter"]);
    assert.match(await points.inputValue(), /^(\d+,\d+ ){2}\d+,\d+$/);
    await canvas.focus();
    await page.keyboard.press("Escape");
    await region.getByText(/3 × 2$/).waitFor({ state: "detached" });
    await page.getByRole("button", { name: "Polygon", exact: true }).click();
    const box = await canvas.boundingBox();
    for (const [x, y] of [[-40, -40], [40, -40], [0, 40]]) await page.mouse.click(box.x + box.width / 2 + x, box.y + box.height / 2 + y);
    assert.match(await points.inputValue(), /^(\d+,\d+ ){2}\d+,\d+$/);
    await page.getByRole("button", { name: "Polygon", exact: true }).click();
    await canvas.press("Escape");
    await page.getByText("Measure", { exact: true }).click();
    // Pressing buttons scrolls.
    await canvas.scrollIntoViewIfNeeded();
  },

  async "a region is dragged, and gives means with a smaller error"({ page }) {
    await page.getByRole("button", { name: "Region" }).click();
    const box = await page.locator(".frame canvas[tabindex]").boundingBox();
    await page.mouse.move(box.x + box.width / 2 - 40, box.y + box.height / 2 - 40);
    await page.mouse.down();
    await page.mouse.move(box.x + box.width / 2 + 40, box.y + box.height / 2 + 20, { steps: 3 });
    await page.mouse.up();
    await page.getByRole("button", { name: "Region" }).click();
    const region = page.getByRole("region", { name: "Region" });
    await region.getByText(/\d+, \d+, \d+ × \d+/).waitFor();
    await region.getByText(/cd\/m²/).waitFor();
    await region.getByText(/^±\u00a0\S+ \(\S+\u00a0%\)$/).waitFor();
  },

  async "a drag moves the image, and a double click puts it back"({ page }) {
    const box = await page.locator(".frame canvas[tabindex]").boundingBox();
    const before = await canvasStatistics(page);
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.mouse.down();
    await page.mouse.move(box.x + box.width / 2 + 60, box.y + box.height / 2 + 60, { steps: 3 });
    await page.mouse.up();
    assert.notEqual((await canvasStatistics(page)).mean, before.mean);
    await page.mouse.dblclick(box.x + box.width / 2, box.y + box.height / 2);
    assert.equal((await canvasStatistics(page)).mean, before.mean);
  },

  async "exposure brightens, and Auto takes it back"({ page }) {
    const before = await canvasStatistics(page);
    const slider = page.getByRole("slider", { name: "Exposure" });
    await slider.focus();
    for (let step = 0; step < 10; step += 1) await page.keyboard.press("ArrowRight");
    await page.getByText("+1.0 EV").waitFor();
    const brighter = await canvasStatistics(page);
    assert.ok(brighter.mean > before.mean + 5, `mean ${before.mean} became ${brighter.mean}`);
    await page.getByRole("button", { name: "Auto" }).click();
    assert.equal((await canvasStatistics(page)).mean, before.mean);
  },

  async "every view, white and tone shows something else"({ page }) {
    const seen = new Map([["colour", (await canvasStatistics(page)).mean]]);
    for (const [label, options] of [["White", ["D50", "E", "Camera", "D65"]], ["Tone", ["Linear", "Filmic", "Reinhard"]], ["View", ["Value", "Standard error", "Relative error", "Samples"]]]) {
      for (const option of options) {
        await choose(page.getByRole("combobox", { name: label }), option);
        seen.set(option, (await canvasStatistics(page)).mean);
      }
    }
    assert.equal(seen.get("D65"), seen.get("colour"));
    assert.equal(seen.get("Reinhard"), seen.get("colour"));
    assert.equal(new Set(seen.values()).size, seen.size - 2, JSON.stringify([...seen]));
    await page.getByRole("combobox", { name: "View" }).selectOption("Value");
    await page.getByRole("group", { name: "Legend" }).getByText("Luminance, cd/m²").waitFor();
    await look(page, "render");
    await page.getByRole("combobox", { name: "View" }).selectOption("Colour");
  },

  async "false colour has a range that is set, read, and given back"({ page }) {
    await page.getByRole("combobox", { name: "View" }).selectOption("Value");
    const before = await canvasStatistics(page);
    await page.getByLabel("Highest value").fill("3e8");
    await page.keyboard.press("Enter");
    await page.getByRole("group", { name: "Legend" }).getByText("1e8").waitFor();
    const darker = await canvasStatistics(page);
    assert.notEqual(darker.mean, before.mean);
    await page.getByLabel("Lowest value").fill("3e7");
    await page.keyboard.press("Enter");
    assert.notEqual((await canvasStatistics(page)).mean, darker.mean);
    await choose(page.getByRole("combobox", { name: "Steps" }), "Linear");
    assert.notEqual((await canvasStatistics(page)).mean, darker.mean);
    await page.getByRole("button", { name: "Auto range" }).press("Enter");
    assert.equal((await canvasStatistics(page)).mean, before.mean);
  },

  async "parts are measured, drawn or typed, and kept with the render"({ page }) {
    await page.getByText("Measure", { exact: true }).click();
    const rows = page.locator(".measure tbody tr");
    await rows.filter({ hasText: "Region 0,0 128,128" }).waitFor();
    await page.getByRole("button", { name: "Line", exact: true }).click();
    // Pressing buttons scrolls.
    const box = await page.locator(".frame canvas[tabindex]").boundingBox();
    await page.mouse.move(box.x + box.width / 2 - 50, box.y + box.height / 2);
    await page.mouse.down();
    await page.mouse.move(box.x + box.width / 2 + 50, box.y + box.height / 2, { steps: 2 });
    await page.mouse.up();
    await page.getByRole("button", { name: "Line", exact: true }).click();
    await page.getByRole("button", { name: "Add" }).press("Enter");
    await rows.filter({ hasText: /^Line \d+,6[345] \d+,6[345]/ }).waitFor();
    await page.getByRole("combobox", { name: "Part" }).selectOption("Polygon");
    await page.getByLabel("Points in pixels").fill("1,1");
    await page.keyboard.press("Enter");
    await page.getByText("Expected three corners or more").waitFor();
    await page.getByLabel("Points in pixels").fill("20,20 60,20 40,50");
    await page.getByLabel("Name of the part").fill("desk");
    await page.keyboard.press("Enter");
    await rows.filter({ hasText: "desk" }).waitFor();
    await page.getByRole("checkbox", { name: "Isolines" }).press("Space");
    await page.waitForResponse((response) => response.url().includes("/isolines"));
    await page.locator(".measure .uplot").waitFor();
    const asked = page.waitForRequest((request) => request.url().includes("/isolines") && request.url().includes("12345"));
    await page.getByLabel("Values of isolines").fill("12345");
    await page.keyboard.press("Enter");
    await asked;
    await rows.filter({ hasText: /^Line/ }).getByRole("radio").focus();
    await page.keyboard.press("Space");
    const profile = page.waitForEvent("download");
    await page.getByRole("link", { name: "Profile as CSV" }).click();
    assert.match(await (await profile).createReadStream().then((stream) => stream.toArray()).then(String), /^distance_pixels,x,y,luminance cd\/m2,standard_error\r\n/);
    const kept = await (await fetch(`${given.url}/v1/renders/${given.small}/regions`)).json();
    assert.deepEqual(kept.regions.map(({ kind, name }) => [kind, name]), [["line", ""], ["polygon", "desk"]]);
    // What the page shows is what the API and the command line say.
    const measured = await (await fetch(`${given.url}/v1/renders/${given.small}:measure`, { method: "POST", body: "{}" })).json();
    const shown = await rows.filter({ hasText: "desk" }).locator("td").nth(1).textContent();
    assert.ok(Math.abs(parseFloat(shown) / measured.measurements[1].mean - 1) < 1e-3, `${shown} is not ${measured.measurements[1].mean}`);
    const download = page.waitForEvent("download");
    await page.getByRole("link", { name: "Table as CSV" }).click();
    assert.match(await (await download).createReadStream().then((stream) => stream.toArray()).then(String), /^name,kind,points,.*\r\n.*\r\ndesk,polygon,"20,20 60,20 40,50",luminance,cd\/m2,600,/);
    await look(page, "measure");
    await page.getByRole("button", { name: "Remove desk" }).press("Enter");
    await rows.filter({ hasText: "desk" }).waitFor({ state: "detached" });
    await page.getByText("Measure", { exact: true }).click();
    await page.getByRole("combobox", { name: "View" }).selectOption("Colour");
  },

  async "glare is told of what is all around an eye"({ page }) {
    const before = page.url();
    await page.goto(at(showing(given.panorama)));
    // Until it is there the page of before is, which can be measured, too.
    await page.getByRole("heading", { name: "lamp in the sky" }).waitFor();
    await page.getByText("Measure", { exact: true }).focus();
    await page.keyboard.press("Enter");
    await page.getByText(/^Glare for who looks at the middle: .*, DGP \d.* lx at the eye/).waitFor();
    await look(page, "glare");
    await page.goto(before);
    await page.locator("canvas[data-updates]").waitFor();
  },

  async "a reload and a link show what was looked at"({ page }) {
    await page.getByRole("combobox", { name: "View" }).selectOption("Value");
    await page.getByLabel("Highest value").fill("3e8");
    await page.keyboard.press("Enter");
    await page.waitForURL("**view=luminance&range=*");
    await page.getByRole("combobox", { name: "White" }).selectOption("D50");
    await page.waitForURL("**&white=D50&*");
    const before = await canvasStatistics(page);
    await page.reload();
    await page.locator("canvas[data-updates]").waitFor();
    await page.getByRole("group", { name: "Legend" }).getByText("1e8").waitFor();
    assert.equal((await canvasStatistics(page)).mean, before.mean);
    assert.equal(await page.getByRole("combobox", { name: "White" }).inputValue(), "D50");
    await page.getByRole("region", { name: "Region" }).getByText(/\d+, \d+, \d+ × \d+/).waitFor();
    // As people type it.
    await page.goto(at(`renders/${given.small}`));
    await page.locator("canvas[data-updates]").waitFor();
    await page.getByText(given.small, { exact: true }).waitFor();
    assert.equal(await page.getByRole("combobox", { name: "View" }).inputValue(), "colour");
    await page.context().grantPermissions(["clipboard-read", "clipboard-write"]);
    await page.getByRole("button", { name: "Copy id" }).focus();
    await page.keyboard.press("Enter");
    await page.locator("#announcer").getByText("The id is copied").waitFor({ state: "attached" });
    assert.equal(await page.evaluate(() => navigator.clipboard.readText()), given.small);
  },

  async "a render is paused, resumed, extended and given another priority"({ page, note }) {
    const state = async (id, wanted) => { await page.locator(`h1 .badge[data-state="${wanted}"]`).waitFor(); note(`${id} ${wanted}`); };
    await page.getByRole("button", { name: "Replay" }).press("Enter");
    await page.waitForFunction((small) => !globalThis.location.hash.includes(small), given.small);
    const id = new URL(page.url()).hash.split("?")[0].split("/").at(-1);
    await state(id, "SUCCEEDED");
    await page.getByRole("button", { name: "Extend…" }).click();
    const dialog = page.getByRole("dialog", { name: "More samples, or another error?" });
    await look(page, "dialog");
    await type(dialog.getByLabel("Stop at a relative error of, %"), "0.001");
    await type(dialog.getByLabel("Samples per pixel, in all"), "1000000");
    await dialog.getByRole("button", { name: "Extend" }).click();
    await state(id, "RUNNING");
    await page.getByRole("button", { name: "Pause" }).click();
    await state(id, "PAUSED");
    const priority = page.getByRole("dialog", { name: "How much of the workers?" });
    await page.getByRole("button", { name: "Priority…" }).click();
    await priority.getByRole("button", { name: "Leave it" }).press("Enter");
    await page.getByRole("button", { name: "Priority…" }).press("Enter");
    await priority.getByLabel("Priority").fill("250");
    await page.keyboard.press("Enter");
    await page.getByRole("dialog").waitFor({ state: "hidden" });
    assert.equal((await (await fetch(`${given.url}/v1/renders/${id}`)).json()).priority, 250);
    // A running render has an EXR, too.
    const exr = await fetch(new URL(await page.getByRole("link", { name: "Download EXR" }).getAttribute("href"), given.url));
    assert.equal(exr.status, 200);
    const scene = await fetch(new URL(await page.getByRole("link", { name: "Scene" }).getAttribute("href"), given.url));
    assert.equal((await scene.json()).nocturne, 1);
    const log = await fetch(new URL(await page.getByRole("link", { name: "Log" }).getAttribute("href"), given.url));
    assert.match(await log.text(), /extend: done|pause: done/);
    const bundle = await fetch(new URL(await page.getByRole("link", { name: "Bundle" }).getAttribute("href"), given.url));
    assert.equal(bundle.headers.get("content-type"), "application/zip");
    await page.getByRole("button", { name: "Resume" }).click();
    await state(id, "RUNNING");
    await page.locator(".workers .traces a").first().waitFor();
    await page.goto(at("#/"));
    // Several at once, by keyboard.
    const box = page.locator("li").filter({ has: page.locator(`a[href="${showing(id)}"]`) }).getByRole("checkbox");
    await box.focus();
    await page.keyboard.press("Space");
    const bar = page.getByRole("group", { name: "Selected renders" });
    await bar.getByText("1 selected").waitFor();
    const selected = async (name, label, value) => {
      await bar.getByRole("button", { name: `${name}…` }).press("Enter");
      await type(page.getByRole("dialog").getByLabel(label), value);
      await page.getByRole("dialog").getByRole("button", { name, exact: true }).press("Enter");
      await bar.waitFor({ state: "hidden" });
      await box.press("Space");
    };
    const told = async () => (await fetch(`${given.url}/v1/renders/${id}`)).json();
    await selected("Priority", "Priority", "300");
    await selected("Extend", /^Samples per pixel/, "2000000");
    await selected("Add tags", "Tags", "night, hall");
    const after = await told();
    assert.deepEqual([after.priority, after.samples, after.tags], [300, 2_000_000, ["night", "hall"]]);
    for (const [name, wanted] of [["Pause", "PAUSED"], ["Resume", "RUNNING"]]) {
      await bar.getByRole("button", { name, exact: true }).press("Enter");
      await bar.waitFor({ state: "hidden" });
      await until(page, `it is ${wanted}`, async () => (await told()).state === wanted);
      await box.press("Space");
    }
    await bar.getByRole("button", { name: "Extend…" }).press("Enter");
    await page.getByRole("dialog").getByRole("button", { name: "Leave them" }).press("Enter");
    await bar.getByRole("button", { name: "Select all" }).press("Enter");
    await bar.getByText(`${await page.locator(".renders li").count()} selected`).waitFor();
    await bar.getByRole("button", { name: "Select none" }).press("Enter");
    await bar.waitFor({ state: "hidden" });
    await box.press("Space");
    await bar.getByRole("button", { name: "Cancel…" }).click();
    await page.getByRole("dialog").getByRole("button", { name: "Keep them" }).press("Enter");
    await bar.getByRole("button", { name: "Cancel…" }).press("Enter");
    await page.getByRole("dialog").getByRole("button", { name: "Cancel", exact: true }).press("Enter");
    await bar.waitFor({ state: "hidden" });
    await box.check();
    await look(page, "selection");
    await bar.getByRole("button", { name: "Delete…" }).press("Enter");
    await page.getByRole("dialog").getByRole("button", { name: "Delete" }).press("Enter");
    await box.waitFor({ state: "detached" });
    await page.goto(at(showing(given.small)));
    await page.locator("canvas[data-updates]").waitFor();
  },

  async "the chart has points, on both axes, and both images can be had"({ page }) {
    await page.locator("figure:not([data-points='0']) .uplot").waitFor();
    await page.getByRole("radio", { name: "Samples per pixel" }).press("Space");
    await page.locator(".u-legend").getByText("Samples per pixel").waitFor();
    await page.reload();
    await page.locator(".u-legend").getByText("Samples per pixel").waitFor();
    await page.getByRole("radio", { name: "Time" }).press("Space");
    await page.getByRole("button", { name: "About Relative error" }).focus();
    const about = page.getByRole("tooltip").filter({ hasText: "Halving it takes four times the samples." });
    await about.waitFor();
    await page.keyboard.press("Escape");
    await about.waitFor({ state: "hidden" });
    const downloads = [["Download EXR", [0x76, 0x2f, 0x31, 0x01]], ["Download PNG", [0x89, 0x50, 0x4e, 0x47]], ["Bundle", [0x50, 0x4b, 0x03, 0x04]]];
    for (const [name, magic] of downloads) {
      const address = await page.getByRole("link", { name }).getAttribute("href");
      const response = await fetch(new URL(address, given.url));
      assert.deepEqual([...new Uint8Array(await response.arrayBuffer()).subarray(0, 4)], magic, name);
    }
    const log = await page.getByRole("link", { name: "Log", exact: true }).getAttribute("href");
    assert.match(await (await fetch(new URL(log, given.url))).text(), /SUCCEEDED/);
  },

  async "the same scene by another engine is one key away"({ page }) {
    await page.goto(at(showing(given.small)));
    const baseline = page.getByRole("link", { name: /^Compare with engine \d+$/ });
    await baseline.focus();
    await page.keyboard.press("Enter");
    await comparing(page);
    await page.goto(at(showing(given.small)));
  },

  async "two renders are compared: wipe, flip, difference, both curves"({ page }) {
    await page.getByRole("link", { name: "Compare…" }).click();
    const choice = page.getByRole("combobox", { name: "Second" });
    const second = await choice.locator(`option[value="${given.other}"]`).evaluate((option) => option.label);
    await choose(choice, second);
    // Arrow keys pass by others.
    assert.ok(!page.url().includes(given.other));
    await choice.press("Enter");
    await comparing(page);
    await page.getByRole("radio", { name: "Wipe" }).waitFor();
    await page.locator(".uplot").waitFor();
    // Ids have letters of any width: the box has to stay narrow with the widest.
    await choice.evaluate((box) => { box.add(new globalThis.Option("W".repeat(60))); });
    await look(page, "compare");
    await choice.evaluate((box) => { box.remove(box.options.length - 1); });
    const place = page.getByRole("slider", { name: "Place of the wipe" });
    await place.fill("0.245");
    await place.press("ArrowRight");
    await page.waitForURL("**wipe=0.250");
    await page.reload();
    await page.getByRole("radio", { name: "Wipe" }).waitFor();
    assert.equal(await place.inputValue(), "0.25");
    await page.getByRole("radio", { name: "Second" }).press("Space");
    await page.waitForURL("**side=second");
    await page.getByRole("radio", { name: "Wipe" }).press("Space");
    await page.getByRole("radio", { name: "First" }).press("Space");
    const first = await canvasStatistics(page);
    await page.getByRole("button", { name: "Flip" }).press("Enter");
    assert.notEqual((await canvasStatistics(page)).mean, first.mean);
    await page.getByRole("combobox", { name: "View" }).selectOption("Difference");
    const { spread } = await canvasStatistics(page);
    assert.ok(spread > 10, `different samples differ in no pixel: ${spread}`);
  },

  async "a render and its own EXR from disk differ nowhere"({ page }) {
    await page.goto(at(`#/compare/${given.small}`));
    await page.locator("canvas[data-updates]").waitFor();
    await chooseFiles(page, page.getByLabel("Reference EXR"), given.exr);
    await page.getByRole("radio", { name: "Wipe" }).waitFor();
    await page.getByRole("combobox", { name: "View" }).selectOption("Difference");
    const { mean, spread } = await canvasStatistics(page);
    // The middle of the diverging map is f7f7f7.
    assert.ok(Math.abs(mean - 247) < 1 && spread < 1, `mean ${mean}, standard deviation ${spread}`);
  },

  async "a scene is dropped on the page, and a folder is chosen"({ page }) {
    await page.goto(at("#/"));
    const data = await page.evaluateHandle((text) => {
      const transfer = new DataTransfer();
      transfer.items.add(new File([text], "fog.json", { type: "application/json" }));
      return transfer;
    }, JSON.stringify(evenLight));
    await page.dispatchEvent("body", "drop", { dataTransfer: data });
    await page.getByText(/^fog\.json/).waitFor();
    await chooseFiles(page, page.getByLabel("choose a folder"), given.scene_folder);
    await page.getByText(/scene\.json/).first().waitFor();
    assert.equal(await page.getByLabel("Name", { exact: true }).inputValue(), "Cornell box");
  },

  async "a wrong scene is refused with the places of its faults"({ page }) {
    await page.goto(at("#/"));
    const wrong = { name: "scene.json", mimeType: "application/json", buffer: Buffer.from('{"nocturne": 1, "sensor": {"type": "fisheye"}}') };
    await chooseFiles(page, page.getByLabel("choose a file"), wrong);
    await page.getByRole("button", { name: "Render", exact: true }).click();
    await page.locator(".problems code").getByText("$.scene.sensor").or(page.locator(".problems code").getByText("$.sensor")).first().waitFor();
  },

  async "a scene is found, and rendered without what it does not need"({ page }) {
    const file = { name: "scene.json", mimeType: "application/json", buffer: Buffer.from(JSON.stringify(evenLight)) };
    await page.getByLabel("choose a file").setInputFiles(file);
    await type(page.getByLabel("Width, pixels"), "12");
    await type(page.getByLabel("Height, pixels"), "12");
    await type(page.getByLabel("Stop at a relative error of, %", { exact: true }), "20");
    await page.getByRole("button", { name: "Preflight" }).press("Enter");
    const cells = (part) => page.locator(".preflight tr").filter({ has: page.getByText(part, { exact: true }) }).locator("th, td").allTextContents();
    // It gives way to all else that the machine does.
    await page.getByText(/^Enough for 20 %: without medium "fog"/).waitFor({ timeout: 400_000 });
    const [, , , cost, verdict] = await cells('without medium "fog"');
    assert.equal(verdict, "not needed");
    assert.ok(parseFloat(cost) < 50, `without all collisions a sample takes ${cost} of the time`);
    assert.equal((await cells("at most 2 interactions"))[4], "needed");
    await look(page, "preflight");
    await page.getByRole("button", { name: "Take the simpler scene" }).press("Enter");
    await page.getByText(/^scene.json, simplified: without medium "fog"/).waitFor();
    const sent = page.waitForRequest((request) => request.method() === "POST" && request.url().endsWith("/v1/renders"));
    await page.getByRole("button", { name: "Render", exact: true }).click();
    const { scene } = (await sent).postDataJSON();
    assert.ok(!scene.surfaces.some(({ interior }) => interior?.media.includes("fog")), JSON.stringify(scene));
    await page.locator('h1 .badge[data-state="SUCCEEDED"]').waitFor();
    await page.goto(at("#/"));
  },

  async "another renderer's scene is imported, without what is not supported if that is wanted"({ page }) {
    await page.goto(at("#/"));
    const text = `<scene version="3.0.0"><sensor type="perspective"><float name="fov" value="40"/>
      <film type="hdrfilm"><integer name="width" value="24"/><integer name="height" value="16"/></film></sensor>
      <shape type="sphere"><point name="center" z="5"/><emitter type="area"/></shape><shape type="nonsense"/></scene>`;
    await page.getByLabel("choose a file").setInputFiles({ name: "ball.xml", mimeType: "text/xml", buffer: Buffer.from(text) });
    await page.locator(".problems").getByText(/no support for the shape "nonsense"/).waitFor();
    await page.getByRole("button", { name: "Import without these" }).press("Enter");
    await page.getByText("ball.xml is imported").waitFor();
    assert.equal(await page.getByLabel("Width, pixels").inputValue(), "24");
    await page.context().grantPermissions(["notifications"]);
    await page.evaluate(() => {
      globalThis.told = [];
      globalThis.Notification = class {
        static permission = "granted";
        static requestPermission() { return Promise.resolve("granted"); }
        constructor(title) { globalThis.told.push(title); }
      };
    });
    await page.getByRole("checkbox", { name: "Notify me of ends" }).press("Space");
    await type(page.getByLabel("Samples per pixel, at most"), "20000");
    await page.getByRole("button", { name: "Render", exact: true }).click();
    await page.locator('h1 .badge[data-state="SUCCEEDED"]').waitFor();
    assert.deepEqual(await page.evaluate(() => globalThis.told), ["ball: Succeeded"]);
    await page.goto(at("#/"));
  },

  async "tags are given, and found by them, by keyboard"({ page }) {
    await page.goto(at(showing(given.small)));
    await page.getByRole("button", { name: "Tags…" }).focus();
    await page.keyboard.press("Enter");
    await page.getByRole("dialog", { name: "Tags" }).getByRole("button", { name: "Leave them" }).press("Enter");
    await page.getByRole("button", { name: "Tags…" }).press("Enter");
    await page.getByRole("dialog", { name: "Tags" }).getByLabel("Tags").fill("lobby, for review");
    await page.keyboard.press("Enter");
    await page.getByText("lobby, for review", { exact: true }).waitFor();
    await page.goto(at("#/"));
    await page.getByRole("searchbox", { name: "Filter" }).fill("review");
    await page.waitForURL("**/#/?find=review");
    await page.reload();
    assert.equal(await page.getByRole("searchbox", { name: "Filter" }).inputValue(), "review");
    await page.locator(".renders li").getByText("#lobby  #for review").waitFor();
    assert.equal(await page.locator(".renders li").count(), 1);
    await page.getByRole("searchbox", { name: "Filter" }).fill("");
  },

  async "frames and variants of a scene are a group"({ page }) {
    await page.getByLabel("choose a file").setInputFiles(given.archive);
    await type(page.getByLabel("Name", { exact: true }), "film");
    await page.getByLabel("Width, pixels").fill("16");
    await page.getByLabel("Height, pixels").fill("16");
    await page.getByLabel("Samples per pixel, at most").fill("4");
    await page.getByText("Frames, variants, groups, bands, tags, further stops").focus();
    await page.keyboard.press("Enter");
    await type(page.getByLabel("Frames", { exact: true }), "2-1");
    await page.getByRole("button", { name: "Render", exact: true }).click();
    await page.getByText("ends before it begins").waitFor();
    await page.getByLabel("Frames", { exact: true }).fill("1-2");
    await page.getByText("ends before it begins").waitFor({ state: "detached" });
    await type(page.getByLabel("Changes of the scene, one a line"), "sensor.position[0]=0.27..0.28");
    await type(page.getByLabel("Variants, one place a line"), "tracing.seed=1,2");
    await type(page.getByLabel("Spectral bands, nm"), "400:700:100");
    await type(page.getByLabel("Tags, between commas"), "film");
    await type(page.getByLabel("Group", { exact: true }), "film by keys");
    await type(page.getByLabel("Begin when this group has ended"), "boxes");
    await type(page.getByLabel("Each tile stops at a relative error of, %"), "0.5");
    await type(page.getByLabel("Stop after, core hours"), "0.25");
    await type(page.getByLabel("Stop at", { exact: true }), "07:00");
    await page.locator("input[name=priority]").fill("120");
    for (const name of ["normal", "position", "object", "material", "indirect"]) await page.getByRole("checkbox", { name }).press("Space");
    await look(page, "sequence");
    await page.getByRole("button", { name: "Render", exact: true }).focus();
    await page.keyboard.press("Enter");
    await page.getByRole("heading", { name: "Group film by keys" }).waitFor();
    await page.getByText(/^4 of 4 renders have ended/).waitFor();
    const { renders } = await (await fetch(`${given.url}/v1/renders?tag=film`)).json();
    assert.deepEqual(renders.map(({ name }) => name).sort(), ["film seed=1 1", "film seed=1 2", "film seed=2 1", "film seed=2 2"]);
    const document = await (await fetch(`${given.url}/v1/renders/${renders[0].id}/scene.json`)).json();
    assert.deepEqual([document.sensor.position[0], document.sensor.bands, document.tracing.seed], [0.28, { first: 400, last: 700, width: 100 }, 2]);
    assert.equal(document.sensor.light_parts, true);
    const { stop, layers, priority, after } = renders[0];
    assert.deepEqual([stop.tile_relative_error, stop.cpu_seconds, layers, priority, after], [0.005, 900, ["normal", "position", "object", "material"], 120, "boxes"]);
    // 07:00 of who typed it.
    const hour = await page.evaluate((seconds) => new Date(1000 * seconds).toLocaleTimeString("en", { hour12: false, hour: "2-digit", minute: "2-digit" }), stop.until_time);
    assert.equal(hour, "07:00");
  },

  async "a render that will miss its error in time says so, and the browser tells of it"({ page }) {
    await page.goto(at("#/"));
    await page.evaluate(() => {
      globalThis.told = [];
      globalThis.Notification = class {
        static permission = "granted";
        static requestPermission() { return Promise.resolve("granted"); }
        constructor(title) { globalThis.told.push(title); }
      };
    });
    await page.getByRole("checkbox", { name: "Notify me of ends" }).check();
    await page.getByLabel("choose a file").setInputFiles(given.archive);
    await page.getByLabel("Samples per pixel, at most").fill("1000000");
    await page.getByLabel("Stop at a relative error of, %", { exact: true }).fill("0.01");
    await type(page.getByLabel("Stop after, minutes"), "1");
    await page.getByRole("button", { name: "Render", exact: true }).click();
    await page.getByText(/^It will have a relative error of about .* asked for, which would take/).waitFor();
    const told = await page.evaluate(() => globalThis.told);
    assert.ok(told.some((title) => title.endsWith(": its error is out of reach")), JSON.stringify(told));
    await look(page, "out-of-reach");
    await page.getByRole("link", { name: "← All renders" }).click();
    await page.getByText(/left, error out of reach$/).waitFor();
    await page.goBack();
    await page.getByRole("button", { name: "Cancel render…" }).click();
    await page.getByRole("dialog", { name: "Cancel this render?" }).getByRole("button", { name: "Cancel render" }).click();
    await page.locator('h1 .badge[data-state="CANCELLED"]').waitFor();
  },

  async "an archive becomes a render whose image changes by itself"({ page }) {
    await page.goto(at("#/"));
    await page.getByLabel("choose a file").setInputFiles(given.archive);
    await page.getByLabel("Samples per pixel, at most").fill("100000");
    await page.getByLabel("Stop at a relative error of, %", { exact: true }).fill("0.1");
    for (const name of ["albedo", "depth", "direct"]) await page.getByRole("checkbox", { name, exact: true }).press("Space");
    await look(page, "list");
    await page.getByRole("button", { name: "Render", exact: true }).click();
    await page.locator("canvas[data-updates]").waitFor();
    await page.getByText("albedo, depth", { exact: true }).waitFor();
    const before = await canvasStatistics(page);
    await nextUpdates(page, 1);
    // The first tiles are at the top; the middle may come later.
    while ((await canvasStatistics(page)).mean === before.mean) await nextUpdates(page, 1);
  },

  async "a region can be asked for first, and shows who works where"({ page }) {
    // Before: parts that have no samples by then get none while the region gets its own.
    await page.locator("figure:not([data-points='0']) .uplot").waitFor();
    const box = await page.locator(".frame canvas[tabindex]").boundingBox();
    await page.keyboard.down("Shift");
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.mouse.down();
    await page.mouse.move(box.x + box.width / 2 + 60, box.y + box.height / 2 + 60, { steps: 3 });
    await page.mouse.up();
    await page.keyboard.up("Shift");
    await page.getByRole("button", { name: "Render the region first" }).press("Enter");
    await page.getByText(/^First: /).waitFor();
    await page.getByRole("checkbox", { name: "Workers" }).press("Space");
    await page.locator(".workers tbody tr").first().waitFor();
    await look(page, "running");
    await page.getByRole("button", { name: "All parts alike" }).press("Enter");
    await page.getByText(/^Choose a region/).waitFor();
  },

  async "the API is killed and comes back: the page goes on without a reload"({ page }) {
    const bar = page.locator("#connection");
    await page.evaluate(() => { globalThis.sameDocument = true; });
    process.kill(given.api_pid, "SIGKILL");
    await bar.getByText("reconnecting").waitFor();
    await bar.getByText("Live").waitFor();
    await nextUpdates(page, 1);
    assert.equal(await page.evaluate(() => globalThis.sameDocument), true);
  },

  async "cancel asks first, and then cancels"({ page }) {
    await page.getByRole("button", { name: "Cancel render…" }).press("Enter");
    const dialog = page.getByRole("dialog", { name: "Cancel this render?" });
    await dialog.getByRole("button", { name: "Keep rendering" }).press("Enter");
    await dialog.waitFor({ state: "hidden" });
    await page.getByRole("button", { name: "Cancel render…" }).press("Enter");
    await dialog.getByRole("button", { name: "Cancel render" }).press("Enter");
    await page.locator('h1 .badge[data-state="CANCELLED"]').waitFor();
  },

  async "delete asks first, and leads back to a list without the render"({ page }) {
    const id = new URL(page.url()).hash.split("?")[0].split("/").at(-1);
    await page.getByRole("button", { name: "Delete render…" }).click();
    const dialog = page.getByRole("dialog", { name: "Delete this render?" });
    await dialog.getByRole("button", { name: "Keep it" }).press("Enter");
    await page.getByRole("button", { name: "Delete render…" }).press("Enter");
    await dialog.getByRole("button", { name: "Delete render" }).press("Enter");
    await page.waitForURL("**/#/");
    await page.locator(`a[href="#/renders/${given.small}"]`).first().waitFor();
    assert.equal(await page.locator(`a[href="#/renders/${id}"]`).count(), 0);
    assert.equal((await fetch(`${given.url}/v1/renders/${id}`)).status, 404);
  },

  async "a worker in quarantine is released, by keyboard"({ page }) {
    const [worker] = (await (await fetch(`${given.url}/v1/workers`)).json()).workers;
    const [program, ...words] = given.quarantine;
    execFileSync(program, [...words, worker.id]);
    await page.goto(at("#/workers"));
    const button = page.getByRole("button", { name: `Release ${worker.id}` });
    await button.focus();
    await page.keyboard.press("Enter");
    await button.waitFor({ state: "detached" });
    await page.getByText("Quarantine", { exact: true }).waitFor({ state: "detached" });
  },

  async "a worker is drained and released, by keyboard"({ page }) {
    const [{ id }] = (await (await fetch(`${given.url}/v1/workers`)).json()).workers;
    await page.getByRole("button", { name: `Drain ${id}` }).focus();
    await page.keyboard.press("Enter");
    await page.getByText(/^Drain(ing|ed)$/).waitFor();
    const release = page.getByRole("button", { name: `Release ${id}` });
    await release.focus();
    await page.keyboard.press("Enter");
    await page.getByRole("button", { name: `Drain ${id}` }).waitFor();
  },

  async "workers and speed have their pages"({ page }) {
    await page.getByRole("link", { name: "Workers" }).click();
    await page.locator(".events").getByText("joined").first().waitFor();
    await page.getByRole("region", { name: "Who uses them" }).getByRole("rowheader", { name: "everybody" }).waitFor();
    await look(page, "workers");
    await page.getByRole("link", { name: "Speed" }).click();
    const boxes = page.getByRole("checkbox", { name: /in the chart$/ });
    await boxes.first().waitFor();
    await page.locator(".plot .uplot").waitFor();
    await boxes.first().focus();
    await page.keyboard.press("Space");
    await page.waitForURL("**/#/speed?renders=*");
    assert.equal(await boxes.first().isChecked(), false);
    await page.getByRole("rowheader", { name: "cornell" }).first().waitFor();
    await look(page, "speed");
    const height = await page.evaluate(() => document.documentElement.scrollHeight);
    assert.ok(height < 4000, `the page is ${height} px long`);
  },

  async "the API's reference shows schemas and examples, and loads nothing from elsewhere"({ page }) {
    const foreign = [];
    page.on("request", (request) => { if (!request.url().startsWith(given.url) && !request.url().startsWith("data:")) foreign.push(request.url()); });
    await page.goto(at("docs"));
    const operation = page.locator("#operations-renders-create_render");
    await operation.getByText("Submits a scene").click();
    await operation.getByText('"vertical_field_of_view_degrees"').first().waitFor();
    await operation.getByText("CONFLICT").first().waitFor();
    assert.deepEqual(foreign, []);
    page.removeAllListeners("request");
  },

  async "a render that does not exist is explained"({ page }) {
    await page.goto(at("#/renders/no-such-render"));
    await page.getByRole("alert").getByText("cannot be shown").waitFor();
  },

  async "a service with tokens asks for one, and forgets it on request"({ page }) {
    await page.goto(`${given.auth_url}/${showing(given.small)}`);
    await page.getByLabel("Token").fill("nct_wrong");
    await page.getByRole("button", { name: "Sign in" }).press("Enter");
    await page.getByRole("alert").getByText("not known").waitFor();
    await look(page, "sign-in");
    await page.getByLabel("Token").fill(given.token);
    await page.keyboard.press("Enter");
    await page.locator("canvas[data-updates]").waitFor();
    await page.locator("#connection").getByText("Live").waitFor();
    assert.equal(await page.evaluate(() => document.cookie), "");
    await page.getByRole("button", { name: "Sign out" }).press("Enter");
    await page.getByLabel("Token").waitFor();
  },
};

/** What a brief visit leaves out: half of the time, in which renders work or views come that nothing else is reached by. */
const onlyWhenWhole = [
  "a denoised picture stands beside the true image, or the service says that it has none",
  "a group is shown as one, by the link of its renders",
  "glare is told of what is all around an eye",
  "a scene is found, and rendered without what it does not need",
  "another renderer's scene is imported, without what is not supported if that is wanted",
  "frames and variants of a scene are a group",
  "a render that will miss its error in time says so, and the browser tells of it",
  "a worker in quarantine is released, by keyboard",
  "a worker is drained and released, by keyboard",
  "the API's reference shows schemas and examples, and loads nothing from elsewhere",
];
assert.deepEqual(onlyWhenWhole.filter((name) => !(name in checks)), []);

const browser = await launch();
try {
  const { page, faults } = await openPage(browser);
  const controls = await noteControls(page);
  for (const [name, check] of Object.entries(checks)) {
    if (given.brief && onlyWhenWhole.includes(name)) continue;
    const start = Date.now();
    const notes = [];
    try {
      await check({ page, note: (text) => notes.push(text) });
    } catch (error) {
      console.log(`failed: ${name}; the page showed:\n${await page.locator("body").innerText()}`);
      throw error;
    }
    console.log(`ok  ${name} (${Date.now() - start} ms)${notes.map((text) => `: ${text}`).join("")}`);
  }
  assert.deepEqual(faults, []);
  assert.ok(given.brief || controls.shown.size > 90, `${controls.shown.size} controls`);
  if (!given.brief) assert.deepEqual([...controls.shown].filter((name) => !controls.keyed.has(name)).sort(), [], "controls that no check uses by keyboard");
} finally {
  await browser.close();
}
