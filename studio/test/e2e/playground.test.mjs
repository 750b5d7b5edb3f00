// The page with the engine of the browser: Python as WebAssembly in a worker, as the playground has it.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { createServer } from "node:http";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";
import { after, before, test } from "node:test";
import { IN_BROWSER, MODELS, PYTHON, Studio, screenshot, write } from "./page.mjs";

let studio;
let page;

before(async () => {
  studio = await Studio.start(IN_BROWSER);
  page = await studio.open({ patience: 60_000 });
});
after(() => studio?.close());

/** What the worker answers, asked beside the page. */
function ask(method, params) {
  const [worker] = page.workers();
  return worker.evaluate(
    ([id, asked, given]) =>
      new Promise((resolve) => {
        const post = self.postMessage;
        self.postMessage = (message) => (message.id === id ? resolve(message.result) : post.call(self, message));
        self.onmessage({ data: { id, method: asked, params: given } });
        self.postMessage = post;
      }),
    ["beside the page", method, params],
  );
}

test("JIWY is checked, drawn and run, in this browser", async () => {
  await page.getByText("In this browser").waitFor();
  await page.getByText("No problems").waitFor();
  await page.locator("#Jiwy-horizontal").waitFor();
  await page.locator("#ui-run-button").click();
  await page.locator("#ui-plots .plot").first().waitFor();
  await page.waitForFunction(() => parseFloat(document.querySelector("#ui-time").textContent) > 0.5);
  await page.locator("#Jiwy-horizontal.running").waitFor();
  await screenshot(page, "playground");
  await page.locator("#ui-run-button").click();
});

test("a recording is that of the command line to the byte", async () => {
  const folder = mkdtempSync(path.join(tmpdir(), "cspdiag-playground-"));
  const jiwy = path.join(MODELS, "jiwy");
  execFileSync(PYTHON, ["-m", "cspdiag", "run", path.join(jiwy, "jiwy.csp"), "--for", "300ms", "--record", path.join(folder, "run.csv")]);
  const files = Object.fromEntries(["jiwy.csp", "laws.csp", "plant.csp"].map((name) => [name, readFileSync(path.join(jiwy, name), "utf8")]));
  const { csv } = await ask("run", { files, main: "jiwy.csp", until: "300 ms" });
  assert.equal(csv, readFileSync(path.join(folder, "run.csv"), "utf8"));
  rmSync(folder, { recursive: true });
});

test("a slip is found as it is written", async () => {
  await write(page, "const period = 1 ms\nconst slow = 10 * peroid\n");
  await page.locator("#ui-problems li", { hasText: "there is no value" }).waitFor();
});

test("an instant without end is said, and the whole diagram fits", async () => {
  const body = "in a : int out b : int communication { var x : int = 0 }";
  const pair = "communication { ping : Ping pong : Pong ping.b -> pong.a pong.b -> ping.a } composition { ping || pong }";
  await write(page, `process Ping { ${body} composition { mu (b ! x ; a ? x) } }\nprocess Pong { ${body} composition { mu (a ? x ; b ! x) } }\nprocess Chatter { ${pair} }\n`);
  await page.locator("#Chatter-ping").waitFor();
  await page.getByRole("button", { name: "Fit" }).click();
  assert.ok(await page.locator("#ui-diagram").evaluate((room) => room.scrollHeight <= room.clientHeight));
  await page.locator("#ui-run-button").click();
  await page.locator("#ui-run-note.bad", { hasText: "stands still at 0.000 s" }).waitFor();
  await page.locator("#ui-stop").click();
});

test("a process that computes without end is stopped, and all else is kept", async () => {
  const text = "process Spin {\n  communication { var k : int = 1 }\n  composition { while k > 0 do (k := k % 1000 + 1) }\n}\n";
  await write(page, text);
  await page.locator("#ui-diagram svg", { hasText: "k" }).waitFor();
  await page.getByText("No problems").waitFor();
  await page.locator("#ui-run-button").click();
  await page.locator("#ui-run-note.bad", { hasText: "Nothing has arrived of the run for 3 s" }).waitFor();
  await page.locator("#ui-stop").click();
  await page.locator("#ui-run-note", { hasText: "Stopping" }).waitFor();
  await page.locator("#ui-run-note", { hasText: "computed for 3 s without a communication" }).waitFor();
  await page.locator("#ui-engine", { hasText: "Starting the engine" }).waitFor();
  await write(page, `${text}// later\nprocess Other { composition { slip } }\n`);
  await page.locator("#ui-problems li", { hasText: "slip" }).waitFor();
  await page.locator("#ui-engine", { hasText: "In this browser" }).waitFor();
});

test("Python in a program reaches nothing but the page", async (context) => {
  let reached = 0;
  const elsewhere = createServer((_, response) => {
    reached += 1;
    response.writeHead(200, { "Access-Control-Allow-Origin": "*" }).end("x");
  });
  await new Promise((resolve) => elsewhere.listen(0, "127.0.0.1", resolve));
  context.after(() => elsewhere.close());
  const address = `http://127.0.0.1:${elsewhere.address().port}/`;
  const csp = `process Hold { in x : double @ 1 ms out y : double communication { var v : double = 0 } composition { mu (x ? v ; y ! v) } }
submodel Spy python "spy.py:Spy" { in u : double out z : double }
environment Bench for Hold step 1 ms { spy : Spy y -> spy.u spy.z -> x }
`;
  const python = `import js

class Spy:
    def __init__(self):
        js.fetch("${address}fetch")
        try:
            request = js.XMLHttpRequest.new()
            request.open("GET", "${address}request", False)
            request.send()
        except Exception as problem:
            print(problem)
        js.WebSocket.new("${address.replace("http", "ws")}")

    def calculate(self, u):
        return 1.0
`;
  const { ended, text } = await ask("run", { files: { "a.csp": csp, "spy.py": python }, main: "a.csp", until: "5 ms" });
  assert.equal(ended, "until", text);
  await page.waitForTimeout(300);
  assert.equal(reached, 0);
});

test("the philosophers are proved to deadlock, which is shown step by step", async () => {
  await page.getByLabel("Example", { exact: true }).selectOption("dining/deadlock");
  await page.locator("#ui-diagram svg", { hasText: "philosopher" }).waitFor();
  await page.getByRole("tab", { name: "Prove" }).click();
  await page.getByRole("button", { name: "Prove all" }).click();
  await page.getByRole("button", { name: "Show the counterexample" }).first().click();
  await page.locator("#ui-film li button", { hasText: "philosopher[0].first" }).first().click();
  await page.locator("#ui-diagram .communicating").first().waitFor({ state: "attached" });
});

test("C is generated", async () => {
  await page.getByRole("tab", { name: "Generate" }).click();
  await page.getByLabel("Target").selectOption("c");
  await page.getByRole("button", { name: "Generate" }).click();
  await page.locator("#ui-listing", { hasText: "csp_" }).waitFor();
});

test("a page that is loaded needs no network, and asks no other host for anything", async () => {
  const context = page.context();
  const asked = [];
  context.on("request", (request) => asked.push(request.url()));
  await page.reload();
  await page.getByText("In this browser").waitFor();
  await context.setOffline(true);
  await page.getByLabel("Example", { exact: true }).selectOption("watchdog");
  await page.getByText("No problems").waitFor();
  await page.locator("#ui-diagram svg", { hasText: "heating" }).waitFor();
  await page.getByRole("tab", { name: "Run", exact: true }).click();
  await page.locator("#ui-run-button").click();
  await page.locator("#ui-plots .plot").first().waitFor();
  await page.waitForFunction(() => parseFloat(document.querySelector("#ui-time").textContent) > 0.1);
  await page.locator("#ui-run-button").click();
  await page.getByRole("tab", { name: "Prove" }).click();
  await page.getByRole("button", { name: "Prove all" }).click();
  await page.locator("#ui-side-prove .word", { hasText: "holds" }).first().waitFor();
  await page.getByRole("tab", { name: "Generate" }).click();
  await page.getByLabel("Target").selectOption("c");
  await page.getByRole("button", { name: "Generate" }).click();
  await page.locator("#ui-listing", { hasText: "csp_" }).waitFor();
  await write(page, "process Other { composition { slip } }\n");
  await page.locator("#ui-problems li", { hasText: "slip" }).waitFor();
  await context.setOffline(false);
  const { origin } = new URL(studio.address);
  assert.deepEqual(asked.filter((address) => new URL(address).origin !== origin), []);
  assert.deepEqual(page.complaints, []);
});
