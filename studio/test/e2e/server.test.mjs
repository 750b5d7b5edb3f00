// The page as `cspdiag studio` serves it.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { cpSync, existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";
import { after, before, test } from "node:test";
import { deflateRawSync } from "node:zlib";
import { chromium } from "playwright-core";
import { CHROMIUM, MODELS, PYTHON, screenshot } from "./page.mjs";

const folder = mkdtempSync(path.join(tmpdir(), "cspdiag-studio-"));
const file = path.join(folder, "buffer.csp");
let server;
let browser;
let address;

before(async () => {
  cpSync(path.join(MODELS, "buffer/buffer.csp"), file);
  writeFileSync(path.join(folder, "yesterday.csv"), "time\n");
  server = spawn(PYTHON, ["-m", "cspdiag", "studio", file, "--no-browser"], { stdio: ["ignore", "pipe", "pipe"] });
  address = await new Promise((resolve, reject) => {
    let said = "";
    const listen = (data) => {
      said += data;
      const found = /http:\/\/\S+/.exec(said)?.[0];
      if (found !== undefined) resolve(found);
    };
    server.stdout.on("data", listen);
    server.stderr.on("data", listen);
    server.on("exit", () => reject(new Error(`cspdiag studio ended: ${said}`)));
  });
  browser = await chromium.launch({ executablePath: CHROMIUM, args: ["--no-sandbox"] });
});
after(async () => {
  await browser?.close();
  server.removeAllListeners("exit");
  server.kill();
  rmSync(folder, { recursive: true, force: true });
});

async function open(hash = "") {
  const page = await browser.newPage({ viewport: { width: 1600, height: 900 } });
  page.setDefaultTimeout(20_000);
  await page.goto(`${address}${hash}`);
  await page.locator("#ui-diagram svg").waitFor();
  return page;
}

test("what is written is saved, and not over what others have written", async () => {
  const page = await open();
  await page.locator(".cm-content").click();
  await page.keyboard.press("Control+Home");
  await page.keyboard.insertText("// written here\n");
  await page.keyboard.press("Control+s");
  await page.getByText("buffer.csp is saved.").waitFor();
  assert.match(readFileSync(file, "utf8"), /^\/\/ written here\n/);
  assert.equal(await page.getByRole("button", { name: "Save" }).isDisabled(), true);
  await page.locator(".cm-content").click();
  await page.keyboard.insertText("// once more\n");
  writeFileSync(file, `// by others\n${readFileSync(file, "utf8")}`);
  await page.getByText(/buffer\.csp: changed on disk as well as here.*reload the page/).waitFor();
  await page.keyboard.press("Control+s");
  await page.getByText(/buffer\.csp has changed on disk.*copy what you want to keep/).waitFor();
  assert.match(readFileSync(file, "utf8"), /^\/\/ by others\n/);
  await page.close();
});

test("what another editor writes is shown, also in a program that was left for an example", async () => {
  const page = await open();
  const before = readFileSync(file, "utf8");
  writeFileSync(file, `// by an editor\n${before}`);
  await page.locator(".cm-line", { hasText: "// by an editor" }).waitFor();
  await page.getByText("buffer.csp: changed on disk, and now shown as on disk.").waitFor();
  assert.equal(await page.getByRole("button", { name: "Save" }).isDisabled(), true);
  await page.getByLabel("Example", { exact: true }).selectOption("watchdog");
  await page.locator(".files button[aria-pressed=true]", { hasText: "watchdog.csp" }).waitFor();
  writeFileSync(file, `// by an editor again\n${before}`);
  await page.getByText("buffer.csp: changed on disk.").waitFor();
  assert.equal(await page.getByLabel("Inputs", { exact: true }).isVisible(), false);
  await page.getByLabel("Example", { exact: true }).selectOption("/");
  await page.locator(".cm-line", { hasText: "// by an editor again" }).waitFor();
  await page.getByLabel("Inputs", { exact: true }).selectOption("yesterday.csv");
  await page.close();
});

test("Python that came by a link is not run before one has agreed", async () => {
  const mark = path.join(folder, "written by the link");
  const program = `process Hold { in x : double @ 1 ms out y : double @ 1 ms safe 0.0 communication { var v : double = 0 } composition { mu (x ? v ; y ! v) } }
submodel Law python "law.py:Law" { in u : double out z : double }
environment Bench for Hold { law : Law y -> law.u law.z -> x }
assert Hold deadlock free
`;
  const law = `open(${JSON.stringify(mark)}, "w").close()\nclass Law:\n    def calculate(self, u):\n        return u\n`;
  const files = { "hold.csp": program, "law.py": law };
  const page = await open(`#code=${deflateRawSync(JSON.stringify({ files, main: "hold.csp" })).toString("base64url")}`);
  await page.getByText("No problems").waitFor();
  assert.equal(await page.getByLabel("Inputs", { exact: true }).isVisible(), false);
  await page.locator("#ui-run-button").click();
  await page.getByRole("dialog").getByText("law.py:Law").waitFor();
  await page.getByRole("button", { name: "Do not run it" }).click();
  assert.equal(existsSync(mark), false);
  await page.locator("#ui-run-button").click();
  await page.getByRole("button", { name: "Run it", exact: true }).click();
  await page.locator("#ui-plots .plot").first().waitFor();
  assert.equal(existsSync(mark), true);
  await page.close();
});

test("of two pages one controls the program, and the other can take control", async () => {
  const first = await open();
  const second = await open();
  const [one, two] = await Promise.all([first, second].map((page) => page.locator("#ui-hand-note", { hasText: "this is page" }).or(page.locator("#ui-hand-note", { hasText: "This is page" })).textContent()));
  assert.match(one, /This is page \d+\. It controls the program; another one watches\./);
  assert.match(two, /Page \d+ controls the program; this is page \d+, and watches\. Take control/);
  assert.equal(/This is page (\d+)/.exec(one)[1], /^Page (\d+)/.exec(two)[1]);
  await second.locator("#ui-run-button:disabled", { hasText: "Watching" }).waitFor();
  for (const choice of ["#ui-environment", "#ui-speed"]) {
    await second.locator(`${choice}:disabled`).waitFor({ state: "attached" });
  }
  assert.match(await second.locator("#ui-run-button").getAttribute("title"), /Another page controls.*take control/);
  // A run that takes a minute.
  await first.getByLabel("Example", { exact: true }).selectOption("jiwy");
  await first.locator("#ui-environment option", { hasText: "Bench" }).waitFor({ state: "attached" });
  await first.getByLabel("Speed").selectOption("0.1");
  await first.locator("#ui-run-button").click();
  for (const page of [first, second]) {
    await page.locator("#ui-plots .plot").first().waitFor();
    await page.waitForFunction(() => parseFloat(document.querySelector("#ui-time").textContent) > 0.01);
  }
  await screenshot(second, "viewer");
  // It looks back, by the button and by the key of the run, while the run of the first one goes on.
  await second.locator("#ui-back").click();
  await second.keyboard.press("F5");
  await second.locator("#ui-time", { hasText: / of / }).waitFor();
  const gone = await first.locator("#ui-time").textContent();
  await first.waitForFunction((before) => document.querySelector("#ui-time").textContent !== before, gone);
  assert.equal(await second.locator("#ui-run-note.bad").count(), 0);
  await second.getByRole("button", { name: "Take control" }).click();
  await first.locator("#ui-hand-note", { hasText: /Page \d+ controls the program/ }).waitFor();
  await second.locator("#ui-run-button:enabled", { hasText: "Pause" }).waitFor();
  // Whoever takes control of a run that was paused meanwhile can resume it.
  await second.locator("#ui-run-button").click();
  await second.locator("#ui-run-button", { hasText: "Resume" }).waitFor();
  await first.getByRole("button", { name: "Take control" }).click();
  await first.locator("#ui-run-button:enabled", { hasText: "Resume" }).waitFor();
  await first.close();
  await second.close();
});

test("a page that watches the program of the files can save them later", async () => {
  const first = await open();
  const second = await open();
  await first.getByLabel("Speed").selectOption("0.1");
  await first.locator("#ui-run-button").click();
  await second.locator("#ui-plots .plot").first().waitFor();
  const before = readFileSync(file, "utf8");
  writeFileSync(file, `// during the run\n${before}`);
  await second.locator(".cm-line", { hasText: "// during the run" }).waitFor();
  await second.getByText("buffer.csp: changed on disk, and now shown as on disk.").waitFor();
  await second.getByRole("button", { name: "Take control" }).click();
  await second.locator(".cm-content").click();
  await second.keyboard.press("Control+Home");
  await second.keyboard.insertText("// by the second\n");
  await second.keyboard.press("Control+s");
  await second.getByText("buffer.csp is saved.").waitFor();
  assert.match(readFileSync(file, "utf8"), /^\/\/ by the second\n\/\/ during the run\n/);
  await first.close();
  await second.close();
});

test("a page that is loaded again in the middle of a run can run the program again", async () => {
  const page = await open();
  await page.getByLabel("Speed").selectOption("0.1");
  await page.locator("#ui-run-button").click();
  await page.waitForFunction(() => parseFloat(document.querySelector("#ui-time").textContent) > 0.01);
  await page.reload();
  await page.locator("#ui-diagram svg").waitFor();
  await page.locator("#ui-run-button:enabled").waitFor();
  await page.locator("#ui-run-button").click();
  await page.locator("#ui-plots .plot").first().waitFor();
  await page.waitForFunction(() => parseFloat(document.querySelector("#ui-time").textContent) > 0.01);
  assert.equal(await page.locator("#ui-run-note.bad").count(), 0);
  await page.close();
});

test("in real time a program keeps pace with the clock, and can be stopped, not paused", async () => {
  const page = await open();
  await page.getByLabel("Example", { exact: true }).selectOption("watchdog");
  await page.locator(".files button[aria-pressed=true]", { hasText: "watchdog.csp" }).waitFor();
  await page.locator("#ui-environment option", { hasText: "Kitchen" }).waitFor({ state: "attached" });
  await page.getByLabel("Speed").selectOption("real time");
  await page.locator("#ui-run-button").click();
  await page.waitForFunction(() => parseFloat(document.querySelector("#ui-time").textContent) > 0.3);
  await page.locator("#ui-run-button:disabled").waitFor();
  await page.locator("#ui-step:disabled").waitFor();
  await page.getByRole("button", { name: "Stop" }).click();
  await page.locator("#ui-run-note", { hasText: /stopped at [\d.]+ m?s/ }).waitFor();
  await screenshot(page, "real-time");
  await page.close();
});

test("a page whose server does not answer says so, and goes on when it does", async () => {
  const page = await open();
  await page.getByLabel("Speed").selectOption("0.1");
  await page.locator("#ui-run-button").click();
  await page.waitForFunction(() => parseFloat(document.querySelector("#ui-time").textContent) > 0.01);
  server.kill("SIGSTOP");
  try {
    await page.locator("#ui-engine.bad", { hasText: "The server does not answer" }).waitFor();
    await page.locator("#ui-run-note", { hasText: "because the server does not answer" }).waitFor();
  } finally {
    server.kill("SIGCONT");
  }
  await page.locator("#ui-engine:not(.bad)", { hasText: "On this machine" }).waitFor();
  await page.locator("#ui-run-note", { hasText: "because the server does not answer" }).waitFor({ state: "hidden" });
  await page.close();
});

test("a program runs as native code, is stepped and stopped, and can be looked back at", async () => {
  const page = await open();
  const code = page.getByRole("combobox", { name: "Code that runs" });
  if (await code.locator("option", { hasText: "C" }).isDisabled()) {
    assert.match(await code.getAttribute("title"), /^Not as C: /);
    await page.close();
    return;
  }
  await code.selectOption("C");
  await page.getByRole("button", { name: "Step" }).click();
  await page.locator("#ui-events li").first().waitFor({ timeout: 60_000 });
  await page.getByRole("button", { name: "Step" }).click();
  await page.waitForFunction(() => document.querySelectorAll("#ui-events li").length > 1);
  await page.getByRole("combobox", { name: "Speed" }).selectOption("fastest");
  await page.getByRole("button", { name: "Resume" }).click();
  await page.getByText("ended by itself at").waitFor();
  await page.getByRole("button", { name: "Back" }).click();
  await page.locator("#ui-time", { hasText: / of / }).waitFor();
  await page.close();
});

test("native code keeps pace with the clock, too", async () => {
  const page = await open();
  const code = page.getByRole("combobox", { name: "Code that runs" });
  await page.getByLabel("Example", { exact: true }).selectOption("watchdog");
  await page.locator(".files button[aria-pressed=true]", { hasText: "watchdog.csp" }).waitFor();
  await page.locator("#ui-environment option", { hasText: "Kitchen" }).waitFor({ state: "attached" });
  if (await code.locator("option", { hasText: "C" }).isDisabled()) {
    await page.close();
    return;
  }
  await code.selectOption("C");
  await page.getByLabel("Speed").selectOption("real time");
  await page.locator("#ui-run-button").click();
  await page.waitForFunction(() => parseFloat(document.querySelector("#ui-time").textContent) > 0.3, undefined, { timeout: 60_000 });
  await page.locator("#ui-run-button:disabled").waitFor();
  await page.locator("#ui-step:disabled").waitFor();
  await screenshot(page, "native-real-time");
  await page.getByRole("button", { name: "Stop" }).click();
  await page.locator("#ui-run-note", { hasText: /stopped at [\d.]+ m?s\s+\d+ instants, late by / }).waitFor();
  await page.close();
});

test("only the code is offered that can call the drivers of the environment", async () => {
  const program = (driver, end) => `${driver}
process Hold { in x : double @ 10 ms out y : double @ 10 ms safe 0.0 communication { var v : double = 0 } composition { mu (x ? v ; y ! v) } }
submodel Still { out x : double x = 1.0 }
environment Bench for Hold { still : Still valve : Valve(${end}) still.x -> x y -> valve.y }
`;
  for (const [text, other, why] of [
    [program('driver Valve() c "valve.c" { in y : double }', ""), "Python", "Not as Python: the driver Valve is written in C"],
    [program('driver Valve(port: int) device "udp" { in y : double }', "port = 9"), "C", "Not as C: the driver Valve is in Python"],
  ]) {
    const page = await open(`#code=${deflateRawSync(JSON.stringify({ files: { "hold.csp": text }, main: "hold.csp" })).toString("base64url")}`);
    const code = page.getByRole("combobox", { name: "Code that runs" });
    await page.locator("#ui-environment option", { hasText: "Bench" }).waitFor({ state: "attached" });
    if ((await page.locator("#ui-code[title*='such command']").count()) === 0) {
      await page.locator("#ui-code option:disabled", { hasText: other }).waitFor({ state: "attached" });
      assert.equal(await code.getAttribute("title"), why);
      assert.notEqual(await code.inputValue(), other.toLowerCase());
    }
    await page.close();
  }
});

test("a page whose server was killed says that the run has ended, and with what", async () => {
  const page = await open();
  await page.getByLabel("Speed").selectOption("0.1");
  await page.locator("#ui-run-button").click();
  await page.waitForFunction(() => parseFloat(document.querySelector("#ui-time").textContent) > 0.01);
  server.removeAllListeners("exit");
  server.kill("SIGKILL");
  await page.locator("#ui-engine.bad", { hasText: "The engine is gone" }).waitFor();
  await page.locator("#ui-run-note.bad", { hasText: "The run has ended, as its engine is gone." }).waitFor();
  await page.close();
});
