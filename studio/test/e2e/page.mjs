// Opens the page in a browser, with an engine of this machine or the scripted one.
import { mkdirSync } from "node:fs";
import path from "node:path";
import { chromium } from "playwright-core";
import { serve } from "../../dev/server.mjs";

const HERE = import.meta.dirname;
/** How the tests are called: the pytest test sets these. */
export const PYTHON = process.env.PYTHON ?? path.join(HERE, "../../../.venv/bin/python");
export const CHROMIUM = process.env.CHROMIUM ?? "/usr/bin/chromium";

export const MODELS = path.join(HERE, "../../../models");
export const REAL = [PYTHON, "-m", "cspdiag.studio.engine"];
export const SCRIPTED = [process.execPath, path.join(HERE, "scripted.mjs")];
export const HOSTILE = [...SCRIPTED, "hostile"];
/** No command: the engine is part of the page. */
export const IN_BROWSER = undefined;

export class Studio {
  static async start(command) {
    const studio = new Studio();
    studio.server = await serve({ command });
    studio.address = command === IN_BROWSER ? studio.server.address.replace(/\?.*/, "") : studio.server.address;
    studio.browser = await chromium.launch({ executablePath: CHROMIUM, args: ["--no-sandbox"] });
    return studio;
  }

  /** A page whose diagram is drawn; what it complains about is in `complaints`. */
  async open({ width = 1600, height = 900, colorScheme = "light", hash = "", patience = 20_000 } = {}) {
    const page = await this.browser.newPage({ viewport: { width, height }, colorScheme, hasTouch: width < 500 });
    page.setDefaultTimeout(patience);
    page.complaints = [];
    page.on("pageerror", (error) => page.complaints.push(error.message));
    await page.goto(`${this.address}${hash}`);
    await page.locator("#ui-diagram svg").waitFor({ state: "attached" });
    return page;
  }

  async close() {
    await this.browser.close();
    await this.server.close();
  }
}

/** What the text has become. */
export function text(page) {
  return page.locator(".cm-content").evaluate((content) => content.cmTile?.view?.state.doc.toString() ?? content.innerText);
}

/** Replaces the whole text. */
export async function write(page, program) {
  await page.locator(".cm-content").click();
  await page.keyboard.press("Control+a");
  await page.keyboard.insertText(program);
}

export async function screenshot(page, name) {
  if (process.env.SCREENSHOTS === undefined) return;
  mkdirSync(process.env.SCREENSHOTS, { recursive: true });
  await page.screenshot({ path: path.join(process.env.SCREENSHOTS, `${name}.png`) });
}
