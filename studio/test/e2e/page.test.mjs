// The page alone, with an engine whose answers are written down.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { after, before, test } from "node:test";
import { deflateRawSync } from "node:zlib";
import { HOSTILE, PYTHON, SCRIPTED, Studio, screenshot, write } from "./page.mjs";

const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
let studio;

before(async () => {
  studio = await Studio.start(SCRIPTED);
});
after(() => studio.close());

test("a mistake is shown with its help, both ends and what fixes it", async () => {
  const page = await studio.open();
  await write(page, "process Pair {\n  left : A\n  slip : B\n}\n");
  const problem = page.locator("#ui-problems li");
  await problem.waitFor();
  assert.match(await problem.textContent(), /E0204.*no value slip.*pair\.csp:3:3.*did you mean left.*declared here.*pair\.csp:2:3/s);
  await page.locator(".cm-lintRange-error").waitFor();
  await page.getByRole("button", { name: "E0204" }).click();
  await page.getByRole("dialog").getByText("not declared").waitFor();
  await page.getByRole("dialog").getByRole("heading", { name: "E0204: an unknown name" }).waitFor();
  await page.keyboard.press("Escape");
  await problem.getByRole("button", { name: "write left" }).click();
  await page.getByText("No problems").waitFor();
  assert.deepEqual(page.complaints, []);
  await page.close();
});

test("the diagram leads to the text, and the cursor lights the diagram", async () => {
  const page = await studio.open();
  await page.locator("#Pair-right").click();
  await page.locator("#Pair-right.lit").waitFor();
  await page.keyboard.press("ArrowUp");
  await page.locator("#Pair-left.lit").waitFor();
  await page.locator("#Pair-right").focus();
  const width = () => page.locator("#ui-diagram svg").evaluate((svg) => svg.clientWidth);
  const fitted = await width();
  await page.keyboard.press("+");
  assert.ok((await width()) > fitted);
  await page.keyboard.press("0");
  assert.equal(await width(), fitted);
  await page.getByLabel("Find in the diagram").fill("token");
  await page.locator("#Pair-token.found.present").waitFor({ state: "attached" });
  await page.close();
});

test("a stick moves what it drives, from the screen and from the keyboard", async () => {
  const page = await studio.open();
  await page.locator("#ui-run-button").click();
  const pad = page.getByRole("slider", { name: /Stick/ });
  await pad.focus();
  for (let i = 0; i < 5; i++) await page.keyboard.press("ArrowRight");
  const circle = page.locator("#ui-plant circle");
  await page.waitForFunction((it) => it.getAttribute("transform") === "translate(125 0)", await circle.elementHandle());
  assert.match(await page.locator("#ui-plant [id$=-arm]").getAttribute("transform"), /^rotate\(/);
  const box = await pad.boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width * 0.14, box.y + box.height / 2);
  await page.waitForFunction((it) => it.getAttribute("transform") === "translate(50 0)", await circle.elementHandle());
  await page.mouse.up();
  await page.waitForFunction((it) => it.getAttribute("transform") === "translate(100 0)", await circle.elementHandle());
  await page.close();
});

test("one can stop, step, go back and scrub", async () => {
  const page = await studio.open();
  await page.locator("#ui-step").click();
  await page.waitForFunction(() => document.querySelector("#ui-time").textContent.startsWith("0.050"));
  await page.locator("#ui-step").click();
  await page.locator("#ui-step").click();
  await page.waitForFunction(() => document.querySelector("#ui-time").textContent.startsWith("0.150"));
  await page.locator("#ui-back").click();
  await page.waitForFunction(() => document.querySelector("#ui-time").textContent.startsWith("0.100 s of 0.150"));
  const before = await page.locator("#ui-plant text").textContent();
  await page.getByLabel("Instant of the run").fill("10");
  await page.waitForFunction((text) => document.querySelector("#ui-plant text").textContent !== text, before);
  await page.locator("#ui-step").click();
  await page.waitForFunction(() => document.querySelector("#ui-time").textContent.startsWith("0.050 s of"));
  await page.close();
});

test("a run that has ended begins again, whatever instant of it is shown", async () => {
  const page = await studio.open();
  await page.locator("#ui-run-button").click();
  await page.waitForFunction(() => parseFloat(document.querySelector("#ui-time").textContent) > 0.3);
  await page.locator("#ui-stop").click();
  await page.getByLabel("Instant of the run").fill("100");
  await page.locator("#ui-step").click();
  await page.waitForFunction(() => document.querySelector("#ui-time").textContent.startsWith("0.150 s of"));
  await page.getByRole("button", { name: "Again" }).click();
  await page.getByRole("button", { name: "Pause" }).waitFor();
  await page.waitForFunction(() => /^0\.\d+ s$/.test(document.querySelector("#ui-time").textContent));
  await page.close();
});

test("a deadlock is seen as it happens, with the processes that wait for each other", async () => {
  const page = await studio.open();
  await page.getByLabel("Speed").selectOption("5");
  await page.keyboard.press("F5");
  await page.getByText("Deadlock: no process can continue.").waitFor();
  assert.equal(await page.locator("#ui-run-note li").first().textContent(), "left waits to write on token, for right");
  await page.locator("#Pair-token.waiting").waitFor({ state: "attached" });
  await screenshot(page, "deadlock");
  await page.close();
});

test("a counterexample is a film, and its suggestion fixes the text", async () => {
  const page = await studio.open();
  await page.getByRole("tab", { name: "Prove" }).click();
  await page.getByRole("button", { name: "Prove all" }).click();
  await page.getByRole("button", { name: "Show the counterexample" }).click();
  await page.locator("#Pair-token.communicating").waitFor({ state: "attached" });
  await page.keyboard.press("ArrowRight");
  await page.locator("#Pair-token.waiting").waitFor({ state: "attached" });
  assert.match(await page.locator("#ui-film .waits").textContent(), /right waits to read/);
  await screenshot(page, "film");
  await page.keyboard.press("Escape");
  assert.equal(await page.evaluate(() => document.activeElement.textContent), "Show the counterexample");
  await page.getByText("Proved after one of these changes:").waitFor();
  await page.getByRole("button", { name: "let left write first" }).waitFor();
  await page.getByRole("button", { name: "let right read first" }).click();
  await page.locator(".cm-line", { hasText: "// fixed" }).waitFor();
  await page.close();
});

test("generated code is read and downloaded, and belongs to the text as it is", async () => {
  const page = await studio.open();
  await page.getByRole("tab", { name: "Generate" }).click();
  await page.getByRole("button", { name: "Generate" }).click();
  await page.locator("#ui-listing", { hasText: "int main" }).waitFor();
  const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Download" }).click()]);
  assert.equal(download.suggestedFilename(), "pair-c.zip");
  const extract = "import sys, zipfile; print(zipfile.ZipFile(sys.argv[1]).read(sys.argv[2]).decode())";
  assert.match(execFileSync(PYTHON, ["-c", extract, await download.path(), "pair-c/pair/pair.c"], { encoding: "utf8" }), /^int main/);
  await page.getByLabel("Target").selectOption("python");
  const [same] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Download" }).click()]);
  assert.equal(same.suggestedFilename(), "pair-c.zip");
  await write(page, "process Other {}\n");
  await page.locator("#ui-listing:empty").waitFor({ state: "attached" });
  await page.close();
});

test("a link holds the program, and the address what is written", async () => {
  const page = await studio.open();
  await write(page, "process Mine {}\n");
  await page.getByRole("button", { name: "Copy link" }).click();
  await page.waitForFunction(() => location.hash.startsWith("#code="));
  const hash = await page.evaluate(() => location.hash);
  await page.close();
  const other = await studio.open({ hash });
  await other.locator(".cm-line", { hasText: "process Mine {}" }).waitFor();
  await write(other, "process Later {}\n");
  await other.waitForFunction((before) => location.hash.startsWith("#code=") && location.hash !== before, hash);
  await other.reload();
  await other.locator(".cm-line", { hasText: "process Later {}" }).waitFor();
  await other.getByLabel("Example", { exact: true }).selectOption("pair");
  await other.locator(".cm-line", { hasText: "left : A" }).waitFor();
  await other.goBack();
  await other.locator(".cm-line", { hasText: "process Later {}" }).waitFor();
  await other.close();
});

test("what a link brings in another language is shown, and run when one has agreed", async () => {
  const files = { "pair.csp": "// python\nprocess Mine {}\n", "plant.py": "class Joint: ...\n" };
  const hash = `#code=${deflateRawSync(JSON.stringify({ files, main: "pair.csp" })).toString("base64url")}`;
  const page = await studio.open({ hash });
  const ask = page.getByRole("dialog", { name: "Run the code that came by this link?" });
  assert.deepEqual(await page.locator(".files button").allTextContents(), ["pair.csp", "plant.py"]);
  for (const begin of ["#ui-run-button", "#ui-step"]) {
    await page.locator(begin).click();
    await ask.getByText("plant.py:Joint").waitFor();
    await page.keyboard.press("F5");
    await page.keyboard.press("Escape");
    await ask.waitFor({ state: "hidden" });
  }
  await page.getByRole("tab", { name: "Prove" }).click();
  await page.getByRole("button", { name: "Prove all" }).click();
  await page.addScriptTag({ content: AXE }).catch(() => page.evaluate(AXE));
  assert.deepEqual(await page.evaluate(async () => (await axe.run("#ui-ask")).violations.map((each) => each.id)), []);
  await screenshot(page, "link");
  await ask.getByRole("button", { name: "Look at plant.py" }).click();
  await page.locator(".cm-line", { hasText: "class Joint" }).waitFor();
  assert.equal(await page.locator("#ui-assertions li.fails").count(), 0);
  await page.getByRole("tab", { name: "Run", exact: true }).click();
  await page.locator("#ui-run-button").click();
  assert.equal(await page.locator("#ui-plots .plot").count(), 0);
  await ask.getByRole("button", { name: "Run it", exact: true }).click();
  await page.locator("#ui-plots .plot").first().waitFor();
  await page.locator("#ui-stop").click();
  await page.getByRole("button", { name: "Again" }).click();
  await page.getByRole("button", { name: "Pause" }).waitFor();
  assert.equal(await ask.isVisible(), false);
  assert.deepEqual(page.complaints, []);
  await page.close();
});

test("the message about a damaged link goes with the next program, which the list of examples names", async () => {
  const page = await studio.open({ hash: "#code=AAAA" });
  await page.getByText("the program in this link is damaged").waitFor();
  await page.evaluate((code) => (location.hash = code), `#code=${deflateRawSync(JSON.stringify({ files: { "pair.csp": "process Good {}" }, main: "pair.csp" })).toString("base64url")}`);
  await page.locator(".cm-line", { hasText: "process Good {}" }).waitFor();
  assert.equal(await page.locator("#ui-message").textContent(), "");
  assert.equal(await page.getByLabel("Example", { exact: true }).inputValue(), "");
  await page.getByLabel("Example", { exact: true }).selectOption("pair");
  await page.locator(".cm-line", { hasText: "process Pair {" }).waitFor();
  await page.goBack();
  await page.locator(".cm-line", { hasText: "process Good {}" }).waitFor();
  await page.close();
});

test("the Tab key reaches every control in the order of the page, each with a name and a visible focus", async () => {
  const page = await studio.open();
  await page.getByText("No problems").waitFor();
  const unreached = await page.evaluate(() => {
    const all = document.querySelectorAll("button, select, input, summary, [tabindex='0']");
    window.unreached = new Set([...all].filter((each) => each.checkVisibility() && !each.disabled && each.tabIndex >= 0));
    return window.unreached.size;
  });
  assert.ok(unreached > 20);
  const wrong = [];
  for (let presses = 0; presses < 80; presses++) {
    await page.keyboard.press("Tab");
    const found = await page.evaluate(() => {
      const here = document.activeElement;
      const before = window.before;
      window.before = here;
      window.unreached.delete(here);
      const name = here.ariaLabel ?? here.labels?.[0]?.textContent ?? (here.textContent.trim() || here.title);
      const isEditor = here.classList.contains("cm-content"); // It has a cursor.
      return {
        end: here === document.body,
        isEditor,
        is: `${here.tagName} ${here.id} ${name}`,
        named: name.trim() !== "",
        follows: before === undefined || (before.compareDocumentPosition(here) & Node.DOCUMENT_POSITION_FOLLOWING) !== 0,
        shown: isEditor || getComputedStyle(here).outlineStyle !== "none",
      };
    });
    if (found.end) break;
    if (!found.named || !found.follows || !found.shown) wrong.push(found);
    // In the text the key indents, after Escape it leaves.
    if (found.isEditor) await page.keyboard.press("Escape");
  }
  assert.deepEqual(wrong, []);
  assert.deepEqual(await page.evaluate(() => [...window.unreached].map((each) => each.outerHTML.slice(0, 100))), []);
  await page.close();
});

test("the border of the text moves, and stays there", async () => {
  const page = await studio.open();
  const width = () => page.locator("#ui-part-text").evaluate((part) => part.offsetWidth);
  const before = await width();
  const box = await page.locator("#ui-splitter").boundingBox();
  await page.mouse.move(box.x + 4, 300);
  await page.mouse.down();
  await page.mouse.move(box.x + 4 - 200, 300, { steps: 4 });
  await page.mouse.up();
  assert.ok(Math.abs((await width()) - (before - 200)) < 12);
  await page.reload();
  await page.locator("#ui-diagram svg").waitFor({ state: "attached" });
  assert.ok(Math.abs((await width()) - (before - 200)) < 12);
  await page.locator("#ui-splitter").dblclick();
  assert.equal(await width(), before);
  await page.close();
});

for (const [width, height] of [[390, 844], [1024, 768], [1600, 900]]) {
  test(`everything is within reach at ${width}, light and dark, and axe finds nothing serious`, async () => {
    const page = await studio.open({ width, height });
    const phone = width < 500;
    if (phone) await page.getByRole("tab", { name: "Run" }).first().click();
    await page.locator("#ui-run-button").click();
    await page.waitForFunction(() => parseFloat(document.querySelector("#ui-time").textContent) > 0.6);
    await page.locator("#ui-run-button").click();
    const tooWide = await page.evaluate(() => document.documentElement.scrollWidth > innerWidth);
    assert.equal(tooWide, false, "the page is wider than the screen");
    await page.evaluate(AXE);
    const check = async (part) => {
      for (const colorScheme of ["light", "dark"]) {
        await page.emulateMedia({ colorScheme });
        const { violations } = await page.evaluate(() => axe.run({ resultTypes: ["violations"] }));
        const serious = violations.filter(({ impact }) => impact === "serious" || impact === "critical");
        assert.deepEqual(serious.map(({ id, nodes }) => [id, nodes.map((node) => node.html.slice(0, 120))]), [], `${part}, ${colorScheme}`);
        await screenshot(page, `${part.toLowerCase()}-${width}-${colorScheme}`);
      }
    };
    for (const part of phone ? ["Text", "Diagram", "Run"] : ["Run"]) {
      if (phone) await page.getByRole("tab", { name: part }).first().click();
      await check(part);
    }
    await page.getByRole("tab", { name: "Prove" }).click();
    await page.getByRole("button", { name: "Prove all" }).click();
    await page.getByRole("button", { name: "Show the counterexample" }).click();
    await check("Prove");
    await page.getByRole("tab", { name: "Generate" }).click();
    await page.getByRole("button", { name: "Generate" }).click();
    await page.locator("#ui-listing", { hasText: "int main" }).waitFor();
    await check("Generate");
    assert.deepEqual(page.complaints, []);
    await page.close();
  });
}

test("hostile texts stay texts, wherever they reach the page", async (context) => {
  const hostile = await Studio.start(HOSTILE);
  context.after(() => hostile.close());
  const page = await hostile.open();
  await write(page, "process Pair {\n  left : A\n  slip : B\n}\nassert Pair deadlock free\n");
  await page.locator("#ui-problems li").waitFor();
  await page.getByRole("button", { name: "E0204" }).click();
  await page.getByRole("dialog").getByText("not declared").waitFor();
  await page.keyboard.press("Escape");
  await page.locator(".cm-line", { hasText: "slip" }).locator("span", { hasText: "slip" }).first().hover();
  await page.locator(".cm-tooltip").first().waitFor();
  await page.locator(".cm-content").click();
  await page.keyboard.press("Control+Space");
  await page.locator(".cm-tooltip-autocomplete").waitFor();
  await page.keyboard.press("Escape");
  await page.getByLabel("Speed").selectOption("5");
  await page.locator("#ui-run-button").click();
  await page.locator("#ui-run-note li").first().waitFor();
  await page.getByRole("tab", { name: "Prove" }).click();
  await page.getByRole("button", { name: "Prove all" }).click();
  await page.getByRole("button", { name: "Show the counterexample" }).click();
  await page.locator("#ui-film .caption").waitFor();
  await page.getByRole("tab", { name: "Generate" }).click();
  await page.getByRole("button", { name: "Generate" }).click();
  await page.locator("#ui-generated li").waitFor();
  await page.locator("#ui-diagram svg > rect").click();
  assert.equal(await page.evaluate(() => window.hacked), undefined);
  assert.equal(await page.locator("body img, body script, svg script, svg image, svg a[href], [onclick], [onload], [onerror]").count(), 0);
  assert.deepEqual(page.complaints, []);
  await page.close();
});
