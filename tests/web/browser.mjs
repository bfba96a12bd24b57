/** Debian's Chromium, driven by the playwright-core that the page's lock file names. */
import assert from "node:assert/strict";
import { mkdirSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";

const require = createRequire(new URL("../../services/web/package.json", import.meta.url));
const { chromium } = require("playwright-core");
const axeSource = require("axe-core").source;

export const desktop = { width: 1000, height: 700 };
export const phone = { width: 390, height: 844 };

export function launch() {
  return chromium.launch({
    executablePath: process.env.NOCTURNE_CHROMIUM ?? "/usr/bin/chromium",
    args: [
      "--no-sandbox",
      // Windows are drawn without OpenGL, which only the image's canvas needs: a third of the visit's processor time.
      "--disable-gpu",
      "--enable-unsafe-swiftshader",
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
  page.setDefaultTimeout(60_000);
  const faults = [];
  page.on("pageerror", (error) => faults.push(error.message));
  page.on("console", (message) => {
    if (message.type() === "error" && /security policy/i.test(message.text())) faults.push(message.text());
  });
  return { page, faults, close: () => context.close() };
}

/**
 * Notes every control that the page shows, and every one at which a key is pressed. The part of a name
 * that says which render, worker or part it is for is left out. Gives both sets.
 */
export async function noteControls(page) {
  const shown = new Set();
  const keyed = new Set();
  await page.exposeFunction("noteShown", (names) => { for (const name of names) shown.add(name); });
  await page.exposeFunction("noteKeyed", (name) => { keyed.add(name); });
  await page.addInitScript(() => {
    // Another program's page.
    if (location.pathname === "/docs") return;
    const kinds = "button, input, select, textarea, summary, canvas[tabindex]";
    const text = (node) => (node?.textContent ?? "").trim();
    const nameOf = (node) => {
      const label = node.labels?.[0];
      const words = node.matches("canvas") ? "Image" : node.name === "part" ? "Part" : node.getAttribute("aria-label") || text(label?.querySelector(":scope > span") ?? label) || text(node) || node.id;
      return words.replace(/^(Select|Remove|Release|Drain|Show|About|Compare with engine) .*/, "$1").replace(/^(Region|Line|Polygon) \d.*/, "$1");
    };
    const known = new WeakSet();
    let timer = 0;
    const look = () => {
      timer = 0;
      const fresh = [...document.querySelectorAll(kinds)].filter((node) => !known.has(node) && node.checkVisibility());
      for (const node of fresh) known.add(node);
      if (fresh.length > 0) void globalThis.noteShown(fresh.map(nameOf));
    };
    const later = () => { timer ||= setTimeout(look, 200); };
    new MutationObserver(later).observe(document, { subtree: true, childList: true, attributes: true, attributeFilter: ["hidden", "open"] });
    // A dialog may be gone before it is looked for.
    document.addEventListener("focusin", look);
    document.addEventListener("keydown", (event) => {
      const node = event.target instanceof Element ? event.target.closest(kinds) : null;
      // Going from one to the next is no use of it.
      if (node && event.key !== "Tab") void globalThis.noteKeyed(nameOf(node));
    }, { capture: true });
  });
  return { shown, keyed };
}

/** Types into a field what is to stand there. */
export async function type(field, text) {
  await field.selectText();
  await field.pressSequentially(text);
}

/** Goes to one of a box's choices with the arrow keys. */
export async function choose(box, label) {
  const stepsTo = (node, text) => [...node.options].findIndex((option) => option.label === text) - node.selectedIndex;
  const steps = await box.evaluate(stepsTo, label);
  for (let step = 0; step < Math.abs(steps); step += 1) await box.press(steps < 0 ? "ArrowUp" : "ArrowDown");
  assert.equal(await box.evaluate((node) => node.selectedOptions[0].label), label);
}

/** Gives files to what opens when Enter is pressed there. */
export async function chooseFiles(page, input, files) {
  const [chooser] = await Promise.all([page.waitForEvent("filechooser"), input.press("Enter")]);
  await chooser.setFiles(files);
}

/** Every control in sight is reached by the Tab key; of radio buttons one of a group. */
async function reachedByTab(page) {
  const missing = () => page.evaluate(() => {
    const controls = [...document.querySelectorAll("a[href], button, input, select, textarea, summary, canvas[tabindex]")].filter((node) => node.checkVisibility({ visibilityProperty: true }) && !node.disabled)
      .filter((node) => node.closest("dialog:modal") || !document.querySelector("dialog:modal"));
    const nameOf = (node) => (node.type === "radio" ? node.name : `${node.tagName} ${node.getAttribute("aria-label") ?? node.labels?.[0]?.textContent ?? node.textContent}`);
    globalThis.onReached ??= document.addEventListener("focusin", (event) => {
      globalThis.reached.names.add(nameOf(event.target));
      globalThis.reached.nodes.add(event.target);
    }) ?? true;
    // By itself, as the image's name tells how many samples it has by now; or by its name, as some are made anew.
    const { names, nodes } = globalThis.reached;
    return controls.filter((node) => !nodes.has(node)).map(nameOf).filter((name) => !names.has(name));
  });
  await page.evaluate(() => { globalThis.reached = { names: new Set(), nodes: new WeakSet() }; document.activeElement?.blur(); });
  let left = await missing();
  // Tables that are made anew while one goes through them begin again.
  for (let round = 0; round < 3 && left.length > 0; round += 1) {
    for (let press = 0; press < left.length + 20; press += 1) await page.keyboard.press("Tab");
    left = await missing();
  }
  return left;
}

/** Mean and spread of the image's colour values as they are on the canvas, 0 to 255, over 100 x 100 in its middle. */
export function canvasStatistics(page) {
  return page.evaluate(async () => {
    const canvas = document.querySelector(".frame canvas");
    await new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)));
    const copy = document.createElement("canvas");
    const [width, height] = [100, 100];
    [copy.width, copy.height] = [width, height];
    const context = copy.getContext("2d", { willReadFrequently: true });
    context.drawImage(canvas, (canvas.width - width) >> 1, (canvas.height - height) >> 1, width, height, 0, 0, width, height);
    const values = context.getImageData(0, 0, copy.width, copy.height).data.filter((_, index) => index % 4 !== 3);
    const mean = values.reduce((sum, value) => sum + value, 0) / values.length;
    const variance = values.reduce((sum, value) => sum + (value - mean) ** 2, 0) / values.length;
    return { mean, spread: Math.sqrt(variance) };
  });
}

/** Waits until `condition` holds; `what` says which, where it never does. */
export async function until(page, what, condition, patience_ms = 60_000) {
  const deadline = Date.now() + patience_ms;
  while (!(await condition())) {
    assert.ok(Date.now() < deadline, `${what}: not within ${patience_ms} ms`);
    await page.waitForTimeout(20);
  }
}

/** Waits until tiles came `count` more times. */
export async function nextUpdates(page, count, patience_ms = 60_000) {
  const updates = () => page.evaluate(() => Number(document.querySelector(".frame canvas")?.dataset.updates ?? 0));
  const goal = (await updates()) + count;
  const deadline = Date.now() + patience_ms;
  while ((await updates()) < goal) {
    assert.ok(Date.now() < deadline, `the image did not change ${count} more times within ${patience_ms} ms`);
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
}

const looks = [
  { name: "light", colorScheme: "light", viewport: desktop },
  { name: "phone", colorScheme: "dark", viewport: phone },
];

/** What reaches farthest beyond the window, and what is in it. */
async function widest(page) {
  return page.evaluate(() => {
    const right = (node) => node.getBoundingClientRect().right;
    const last = [...document.querySelectorAll("body *")].filter((node) => right(node) > document.documentElement.clientWidth - 20)
      .sort((a, b) => right(b) - right(a)).slice(0, 6);
    return last.map((node) => `<${node.tagName.toLowerCase()} class="${node.getAttribute("class") ?? ""}"> to ${right(node)}: ${(node.textContent ?? "").slice(0, 60)}`).join("; ");
  });
}

/** Of the next view axe looks at this one alone. */
let turn = 0;

/**
 * Looks right to a machine: nothing wider than the window, no fault that axe knows, all in reach of the keyboard. Keeps pictures for
 * docs/how-to/page.md in a folder, if there is one. Without one axe, which takes most of the time, looks at the views in turns light and as on a phone.
 */
export async function checkLooks(page, name, folder) {
  if (folder) mkdirSync(folder, { recursive: true });
  turn = (turn + 1) % looks.length;
  for (const [index, look] of looks.entries()) {
    await page.emulateMedia({ colorScheme: look.colorScheme });
    await page.setViewportSize(look.viewport);
    await page.waitForTimeout(150);
    if (folder && look.name === "light") await savePicture(page, `${name}-${look.name}`, folder);
    const excess = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
    assert.equal(excess, 0, `${name} is ${excess} px wider than the window: ${look.name}; ${excess > 0 ? await widest(page) : ""}`);
    if (folder || index === turn) assert.deepEqual(await accessibilityFaults(page), [], `${name}, ${look.name}`);
  }
  await page.setViewportSize(desktop);
  await page.emulateMedia({ colorScheme: "light" });
  assert.deepEqual(await reachedByTab(page), [], `${name}: not reached by the Tab key`);
}

/** The whole page, for docs/how-to/page.md. */
export async function savePicture(page, name, folder) {
  // Rows of the list are drawn near the window only.
  await page.evaluate(() => new Promise((done) => {
    globalThis.scrollTo(0, 0);
    requestAnimationFrame(() => requestAnimationFrame(done));
  }));
  writeFileSync(join(folder, `${name}.webp`), await webp(page));
}

/** The browser makes it small: pictures stand in the repository. */
async function webp(page) {
  const png = await page.screenshot({ fullPage: true });
  const base64 = await page.evaluate(async (text) => {
    const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    const bitmap = await createImageBitmap(new Blob([bytes]));
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [bitmap.width, bitmap.height];
    canvas.getContext("2d").drawImage(bitmap, 0, 0);
    return canvas.toDataURL("image/webp", 0.8).split(",")[1];
  }, png.toString("base64"));
  return Buffer.from(base64, "base64");
}

/** By all rules of axe's. */
async function accessibilityFaults(page) {
  if (!(await page.evaluate(() => "axe" in globalThis))) await page.evaluate(axeSource);
  const { violations } = await page.evaluate(() => globalThis.axe.run({ resultTypes: ["violations"] }));
  return violations
    .map(({ id, nodes }) => `${id}: ${nodes.map(({ html }) => html).join(", ")}`);
}
