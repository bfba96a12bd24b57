/**
 * The light of a room on the page, for those who plan it. Environment: NOCTURNE_E2E, JSON of
 *   url: the service; year: a render of daylight coefficients whose group has ended; room: an ended render of meters;
 *   screenshots: a folder; empty: no pictures are kept.
 * Prints a line per check; exit code 1 at the first that fails.
 */
import assert from "node:assert/strict";
import { checkLooks, choose, launch, openPage, type } from "./browser.mjs";

const given = JSON.parse(process.env.NOCTURNE_E2E);
const open = (page, id) => page.goto(`${given.url}/#/renders/${encodeURIComponent(id)}`);
/** A report takes seconds, and many on a busy machine. */
const patience_ms = 240_000;
const look = (page, name) => checkLooks(page, name, given.screenshots);

const checks = {
  async "a year of daylight begins with its verdict, and is counted again by keyboard"(page) {
    await open(page, given.year);
    const section = page.getByRole("region", { name: "A year of daylight" });
    await section.getByText(/^sDA [\d.]+\s% \([\d.]+ to [\d.]+\), P\(sDA ≥ 55\s%\) [=<>] [\d.]+$/).waitFor({ timeout: patience_ms });
    await section.getByText(/^ASE /).waitFor();
    await section.getByRole("img", { name: /by day of the year/ }).waitFor();
    await section.getByRole("img", { name: /^DA at the points of plane, %/ }).waitFor();
    const figures = section.getByRole("combobox", { name: "Plan of" });
    await choose(figures, "mean illuminance");
    await section.getByRole("img", { name: /^mean illuminance at the points of plane, lx/ }).waitFor();
    await section.getByText("Months in numbers").press("Enter");
    await section.getByRole("rowheader", { name: "June" }).waitFor();
    const mean = section.getByRole("row", { name: /^DA / });
    const before = await mean.innerText();
    await type(section.getByLabel("Enough light, lx"), "3000");
    await page.keyboard.press("Enter");
    await page.waitForFunction((text) => ![...document.querySelectorAll("tr")].some((row) => row.innerText === text), before);
    await look(page, "year");
    const link = section.getByRole("link", { name: "All figures as JSON" });
    const told = await page.evaluate(async (address) => (await fetch(address)).json(), await link.getAttribute("href"));
    assert.equal(told.hourly.length, 8760);
  },

  async "a room's result comes first, with a report"(page) {
    await open(page, given.room);
    const section = page.getByRole("region", { name: "Result" });
    await section.getByRole("columnheader", { name: /U0/ }).first().waitFor({ timeout: patience_ms });
    await choose(section.getByRole("combobox", { name: "Requirement" }), "EN 12464-1, 34.2 writing, typing, reading");
    await section.getByRole("button", { name: "Show the result" }).press("Enter");
    await section.getByRole("rowheader", { name: /^Em, / }).waitFor({ timeout: patience_ms });
    await section.locator(".verdict strong").getByText(/^(Holds|Does not hold|Open)$/).waitFor();
    await look(page, "result");
    for (const name of ["Report as PDF", "Report as HTML"]) {
      const address = await section.getByRole("link", { name }).getAttribute("href");
      assert.match(address, /require=EN\+12464-1%3A34\.2/);
      const [status, kind] = await page.evaluate(async (link) => {
        const answer = await fetch(link);
        return [answer.status, answer.headers.get("content-type")];
      }, address);
      assert.equal(status, 200, name);
      assert.match(kind, name.endsWith("PDF") ? /pdf/ : /html/);
    }
    await choose(section.getByRole("combobox", { name: "Requirement" }), "Limits by hand");
    await type(section.getByRole("textbox", { name: "Limits" }), "Em=0");
    await page.keyboard.press("Enter");
    await section.getByRole("alert").getByText(/expected/).waitFor();
  },
};

const browser = await launch();
try {
  const { page, faults } = await openPage(browser);
  for (const [name, check] of Object.entries(checks)) {
    const start = Date.now();
    try {
      await check(page);
    } catch (error) {
      console.log(`failed: ${name}; the page showed:\n${await page.locator("body").innerText()}`);
      throw error;
    }
    console.log(`ok  ${name} (${Date.now() - start} ms)`);
  }
  assert.deepEqual(faults, []);
} finally {
  await browser.close();
}
