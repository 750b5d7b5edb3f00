// Opens pages, and prints for each, as a line of JSON, the addresses that it has asked for, its links in an element, and its errors.
//   node test/e2e/visit.mjs ELEMENT ADDRESS...
import { chromium } from "playwright-core";

const [element, ...addresses] = process.argv.slice(2);
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: ["--no-sandbox", "--allow-file-access-from-files"] });
try {
  for (const address of addresses) {
    const page = await browser.newPage();
    const [asked, errors] = [[], []];
    page.on("request", (request) => asked.push(request.url()));
    page.on("pageerror", (error) => errors.push(error.message));
    await page.goto(address);
    await page.locator(`${element} a`).first().waitFor({ state: "attached" });
    await page.waitForLoadState("networkidle");
    const links = await page.locator(`${element} a`).evaluateAll((all) => all.map((link) => link.getAttribute("href")));
    console.log(JSON.stringify({ asked, links, errors }));
    await page.close();
  }
} finally {
  await browser.close();
}
