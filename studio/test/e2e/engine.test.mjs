// The page with the engine of this checkout.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { deflateRawSync } from "node:zlib";
import { REAL, Studio, screenshot, write } from "./page.mjs";

let studio;

before(async () => {
  studio = await Studio.start(REAL);
});
after(() => studio.close());

/** A program of the list. */
async function choose(page, name) {
  await page.getByLabel("Example", { exact: true }).selectOption(name);
}

test("JIWY is there at once, with its diagram and the picture of its plant", async () => {
  const page = await studio.open();
  await page.locator(".cm-line", { hasText: 'import "laws.csp"' }).waitFor();
  await page.locator("#Jiwy-horizontal").waitFor();
  await page.getByText("pan, from above").waitFor();
  await page.getByText("No problems").waitFor();
  await screenshot(page, "jiwy");
  assert.deepEqual(page.complaints, []);
  await page.close();
});

test("a program of a link that cannot be read says so in place of the problems of the one before", async () => {
  const page = await studio.open();
  const link = (files, main) => `#code=${deflateRawSync(JSON.stringify({ files, main })).toString("base64url")}`;
  await page.evaluate((hash) => (location.hash = hash), link({ "a.csp": "process A { composition { slip } }" }, "a.csp"));
  await page.locator("#ui-problems li", { hasText: "slip" }).waitFor();
  await page.evaluate((hash) => (location.hash = hash), link({ "b.csp": "process \0" }, "b.csp"));
  await page.locator("#ui-problems li", { hasText: "b.csp has zero bytes" }).waitFor();
  assert.equal(await page.locator("#ui-problems li").count(), 1);
  await page.close();
});

test("a diagram is shown whole where it is legible", async () => {
  const page = await studio.open({ width: 1440 });
  const many = (each) => [1, 2, 3, 4].map(each).join(" ");
  await write(page, `process A { out o : int composition { mu (o ! 1) } }
process Tall {
  out ${[1, 2, 3, 4].map((k) => `o${k}`).join(", ")} : int
  communication { ${many((k) => `a${k} : A a${k}.o -> o${k}`)} }
  composition { a1 || a2 || a3 || a4 }
}
`);
  await page.locator("#Tall-a4").waitFor();
  const room = await page.locator("#ui-diagram").evaluate(({ scrollHeight, clientHeight }) => ({ scrollHeight, clientHeight }));
  assert.ok(room.scrollHeight <= room.clientHeight, JSON.stringify(room));
  await page.close();
});

test("what is inside of what is shown is found, and shown", async () => {
  const page = await studio.open();
  await page.getByLabel("Find in the diagram").fill("servo");
  await page.locator(".found.present").first().waitFor({ state: "attached" });
  assert.equal(await page.getByLabel("Levels shown").inputValue(), "3");
  await page.close();
});

test("an instance is opened by keyboard, and its composition shown", async () => {
  const page = await studio.open();
  await page.locator("#Jiwy-horizontal").focus();
  await page.keyboard.press("Shift+Enter");
  await page.locator("#ui-diagram svg", { hasText: "motionControl" }).waitFor();
  await page.getByLabel("Kind of diagram").selectOption("composition");
  await page.locator("#ui-diagram .cspdiag", { hasText: "alignR" }).waitFor();
  await page.getByLabel("Kind of diagram").selectOption("communication");
  await page.getByLabel("Process", { exact: true }).selectOption("");
  await page.locator("#Jiwy-horizontal").waitFor();
  await page.getByLabel("Levels shown").selectOption("2");
  await page.locator("#ui-diagram svg", { hasText: "motionControl" }).waitFor();
  await page.close();
});

test("a slip is found as it is written, explained and fixed", async () => {
  const page = await studio.open();
  await write(page, "const period = 1 ms\nconst slow = 10 * peroid\n");
  await page.locator("#ui-problems li", { hasText: "there is no value" }).waitFor();
  await page.getByRole("button", { name: "E0204" }).click();
  await page.getByRole("dialog").getByText("Refused:").waitFor();
  await page.keyboard.press("Escape");
  await page.locator("#ui-problems .fix").first().click();
  await page.locator(".cm-line", { hasText: "10 * period" }).waitFor();
  await page.getByText("No problems").waitFor();
  await page.close();
});

test("completion, hover and format come from the engine", async () => {
  const page = await studio.open();
  await write(page, "process  Quiet {\n  composition { sk");
  await page.keyboard.press("Control+Space");
  await page.locator(".cm-tooltip-autocomplete li", { hasText: "skip" }).click();
  await page.keyboard.press("Control+End");
  await page.keyboard.insertText(" }\n}\n");
  await page.getByText("No problems").waitFor();
  await page.keyboard.press("Shift+Alt+F");
  await page.locator(".cm-line", { hasText: "process Quiet {" }).waitFor();
  await page.locator(".cm-line", { hasText: "process Quiet {" }).locator("span", { hasText: "Quiet" }).hover();
  await page.locator(".cm-tooltip .hover").waitFor();
  await page.close();
});

test("the philosophers deadlock before one's eyes, and the suggestion fixes them", async () => {
  const page = await studio.open();
  await choose(page, "dining/deadlock");
  await page.locator("#ui-diagram svg", { hasText: "philosopher" }).waitFor();
  await page.getByRole("tab", { name: "Prove" }).click();
  await page.getByRole("button", { name: "Prove all" }).click();
  await page.getByRole("button", { name: "Show the counterexample" }).first().click();
  await page.keyboard.press("ArrowRight");
  await page.locator("#ui-diagram .communicating").first().waitFor({ state: "attached" });
  for (let i = 0; i < 12; i++) await page.keyboard.press("ArrowRight");
  await page.locator("#ui-diagram .waiting").first().waitFor({ state: "attached" });
  assert.match(await page.locator("#ui-film .waits").textContent(), /philosopher\[0\] waits/);
  assert.match(await page.locator("#ui-film .who-waits p").textContent(), /^In a ring each waits for the next: .*fork\[\d\], .*, and that again for /);
  await screenshot(page, "philosophers");
  await page.close();
});

for (const name of ["buffer", "cascade", "commstime", "emergency", "ring", "watchdog"]) {
  test(`${name} is drawn without problems`, async () => {
    const page = await studio.open();
    await choose(page, name);
    await page.locator(`.files button[aria-pressed=true]`, { hasText: `${name}.csp` }).waitFor();
    await page.locator("#ui-diagram:not(.stale) svg").waitFor();
    await page.getByText(/No problems|warning/).first().waitFor();
    assert.deepEqual(page.complaints, []);
    await page.close();
  });
}

test("JIWY moves: the stick turns it, one can go back, and its modes are seen", async () => {
  const page = await studio.open();
  await page.getByText("No problems").waitFor();
  await page.locator("#ui-run-button").click();
  const arm = page.locator("#ui-plant [data-rotate]").first();
  const angle = async () => Number(/rotate\(([-\d.e]+)/.exec(await arm.getAttribute("transform"))?.[1]);
  const pan = page.locator("#ui-modes .row", { hasText: "horizontal" }).locator("output");
  await page.waitForFunction((it) => it.textContent === "motionControl", await pan.elementHandle());
  await page.locator("#ui-run-button").click();
  const before = await angle();
  await page.getByRole("slider", { name: /Stick/ }).focus();
  for (let i = 0; i < 8; i++) await page.keyboard.press("ArrowRight");
  await page.locator("#ui-run-button").click();
  await page.waitForFunction(
    ([it, from]) => Math.abs(Number(/rotate\(([-\d.e]+)/.exec(it.getAttribute("transform"))[1]) - from) > 20,
    [await arm.elementHandle(), before],
  );
  await page.locator("#Jiwy-horizontal.running").waitFor();
  await page.locator("#ui-run-button").click();
  await screenshot(page, "jiwy-moves");
  await page.getByLabel("Instant of the run").fill("1000");
  await page.waitForFunction((it) => it.textContent === "alignL", await pan.elementHandle());
  await page.locator("#ui-step").click();
  await page.locator("#ui-diagram .communicating").first().waitFor({ state: "attached" });
  assert.deepEqual(page.complaints, []);
  await page.close();
});

test("a parameter is changed while the program runs", async () => {
  const page = await studio.open();
  await page.getByText("Parameters (12)").click();
  const slider = page.getByLabel("panGains.kp");
  await page.locator("#ui-run-button").click();
  await page.locator("#Jiwy-horizontal.running").waitFor();
  await slider.focus();
  await page.keyboard.press("ArrowRight");
  await page.waitForTimeout(300);
  assert.equal(await page.locator("#ui-run-note").isHidden(), true, await page.locator("#ui-run-note").textContent());
  await page.close();
});

test("a run begins with the values that the sliders show", async () => {
  const page = await studio.open();
  const text = `parameter gain : double = 2
process Amplify {
  in  u : double @ 10 ms
  out y : double @ 10 ms
  communication { law : Law  u -> law.u  law.y -> y }
  composition { mu law }
}
submodel Law { in u : double  out y : double  y = gain * u }
submodel One { out u : double  u = 1 }
environment Bench for Amplify { one : One  one.u -> u  y -> _ }
`;
  await write(page, text);
  const slider = page.locator("#ui-parameters input");
  await page.locator("#ui-parameters", { hasText: "Parameters (1)" }).waitFor();
  const shown = async (value) => {
    await page.locator("#ui-run-button").click();
    await page.locator("#ui-events li", { hasText: `Amplify.y${value}` }).first().waitFor();
    await page.locator("#ui-stop").click();
  };
  await slider.fill("3");
  await shown(3);
  await slider.fill("4");
  await shown(4);
  await slider.dblclick();
  await shown(2);
  await page.close();
});

test("the philosophers run into their deadlock", async () => {
  const page = await studio.open();
  await choose(page, "dining/deadlock");
  await page.locator("#ui-diagram svg", { hasText: "philosopher" }).waitFor();
  await page.locator("#ui-run-button").click();
  await page.locator("#ui-run-note.bad li", { hasText: "philosopher[0] waits" }).waitFor();
  await page.locator("#ui-diagram .waiting").first().waitFor({ state: "attached" });
  await screenshot(page, "philosophers-run");
  await page.close();
});
