// The extension in an editor, as its user meets it.
import assert from "node:assert/strict";
import { existsSync, mkdirSync, readFileSync, unlinkSync, writeFileSync } from "node:fs";
import path from "node:path";
import { after, before, test } from "node:test";
import { Editor } from "./editor.mjs";

const MODELS = path.join(import.meta.dirname, "../../../../models");
const HALF = "process Good {\n  composition { skip }\n}\n\nprocess Bad {\n  composition { skip ; ) }\n}\n";
const SLIP = "const period = 1 ms\nconst slow = 10 * peroid\n";

const CROSSED = `process Left { out a : int in b : int communication { var x : int } composition { a ! 1 ; b ? x } }
process Right { in a : int out b : int communication { var x : int } composition { a ? x ; b ! 2 ; a ? x } }
process Main {
  communication {
    left : Left
    right : Right
    left.a -> right.a
    right.b -> left.b
  }
  composition { left || right }
}
assert Main deadlock free
`;

const FAULT = `process Divider {
  out y : int
  communication { var z : int = 0 }
  composition { y ! 1 ; z := 1 / z ; y ! z }
}
environment Bench for Divider { y -> _ }
`;

/** Runs for some seconds. */
const COUNT = `import "used.csp"
process Counter { communication { var n : int = 0 } composition { mu (n := n + 1 ; wait 1 us) } }
environment Bench for Counter { }
`;

/** Time stands still in it. */
const SPIN = `process Give { out to : int in back : int
  communication { var b : int } composition { mu (to ! 1 ; back ? b) } }
process Take { in from : int out back : int communication { var f : int } composition { mu (from ? f ; back ! f) } }
process Spin {
  communication {
    give : Give
    take : Take
    give.to -> take.from
    take.back -> give.back
  }
  composition { give || take }
}
environment Floor for Spin { }
`;

/** Waits all the time. */
const IDLE = `process Idle { composition { mu (wait 100 ms) } }
environment Room for Idle { }
`;

/** Has two thousand million states. */
const SLOW = `process Main {
  in  x : double @ 1 ms
  out y : double @ 1 ms
  communication {
    var v : double
    var n : int = 0
  }
  composition {
    mu (x ? v ; n := (n * 1103515245 + 12345) % 2147483648 ; if n == 7777777 then stop else y ! v)
  }
}
assert Main deadlock free
`;

const MANY = `process Leaf { composition { skip } }
process Many {
  communication {
${Array.from({ length: 14 }, (_, k) => `    a${k} : Leaf`).join("\n")}
  }
  composition { ${Array.from({ length: 14 }, (_, k) => `a${k}`).join(" || ")} }
}
`;

/** @type {Editor} */
let editor;

/** A test; a picture shows what the editor looked like when it failed. */
function step(name, act) {
  test(name, async () => {
    try {
      await act();
    } catch (problem) {
      await editor.screenshot(`failed - ${name}`);
      throw problem;
    }
  });
}

before(async () => {
  const jiwy = (name) => ({ copy: path.join(MODELS, "jiwy", name) });
  const files = { "slip.csp": SLIP, "half.csp": HALF, "only.csp": HALF.slice(HALF.indexOf("process Bad")), "crossed.csp": CROSSED, "many.csp": MANY, "fault.csp": FAULT, "count.csp": COUNT, "spin.csp": SPIN, "used.csp": "const unused = 1\n", "wrong.csp": FAULT.replace("z ;", "w ;"), "slow.csp": SLOW, "large.csp": `const a = 1 // ${"x".repeat(99)}\n`.repeat(90_000), "latin.csp": Buffer.from("// caf\xe9\n", "latin1") };
  const task = { label: "say", type: "shell", command: "cat said.txt", problemMatcher: ["$cspdiag", "$cspdiag-absolute"], presentation: { reveal: "never" }, group: { kind: "build", isDefault: true } };
  files[".vscode/tasks.json"] = JSON.stringify({ version: "2.0.0", tasks: [task] });
  for (const name of ["jiwy.csp", "laws.csp", "plant.csp"]) files[name] = jiwy(name);
  files["dining/dining.csp"] = "process Dining { composition { skip } }\n";
  editor = await Editor.start({ files, folder: "my project #1" });
});

after(() => editor.close());

step("a mistake is shown as a diagnostic", async () => {
  await editor.open("slip.csp");
  await editor.page.locator(".squiggly-error").first().waitFor();
  await editor.goTo(2, 20);
  await editor.command("Problems: Focus on Problems View");
  await editor.page.locator(".markers-panel", { hasText: "there is no value `peroid`" }).waitFor();
  await editor.screenshot("slip");
});

step("a snippet is offered only where what it begins with can be", async () => {
  const offered = (label) => editor.page.locator(`.suggest-widget.visible .monaco-list-row[aria-label^="${label}"]`);
  await editor.goTo(2, 25);
  await editor.page.keyboard.press("Enter");
  await editor.page.keyboard.type("integ", { delay: 50 });
  await offered("integrator").waitFor();
  await editor.page.keyboard.press("Escape");
  await editor.command("File: Revert File");
  await editor.goTo(2, 25);
  await editor.page.keyboard.press("Enter");
  await editor.page.keyboard.type("process Loom { in thread : int", { delay: 50 });
  await offered("int8").waitFor();
  assert.equal(await offered("integrator").count(), 0);
  await editor.page.keyboard.press("Escape");
  await editor.command("File: Revert File");
});

step("the problems of a task are shown, also of the last file, beside those of the server", async () => {
  const files = ["slip.csp", "first.csp", "second.csp", path.join(editor.folder, "third.csp")];
  editor.program("said.txt", files.map((file) => `${file}:1:1: error[E0204] of the task\n`).join(""));
  const badge = editor.page.locator(".panel .action-item", { hasText: "Problems" }).locator(".badge", { hasText: "4" });
  await editor.until(async () => {
    await editor.page.keyboard.press("Control+Shift+b"); // Tasks are known some time after the editor is there.
    await new Promise((resolve) => setTimeout(resolve, 2_000));
    return (await badge.count()) > 0;
  });
  await editor.page.locator(".squiggly-error").first().waitFor();
  await editor.command("Problems: Focus on Problems View");
  await editor.page.locator(".markers-panel", { hasText: "there is no value `peroid`" }).waitFor();
});

step("the diagram is beside the text, and lit where the cursor is", async () => {
  await editor.command("View: Hide Panel");
  // Without the list of files there is more room for the diagram.
  await editor.page.keyboard.press("Control+b");
  await editor.open("jiwy.csp", 29, 6);
  await editor.page.keyboard.press("Control+Shift+v");
  await editor.diagram.locator("svg").waitFor();
  await editor.diagram.locator("#Align-velocity.lit").waitFor();
});

step("a click on an element goes to the text", async () => {
  await editor.diagram.locator("#Align-failed").click();
  await editor.cursorIn(30);
  await editor.diagram.locator("#Align-failed.lit").waitFor();
});

step("elements can be reached and opened by the keyboard", async () => {
  await editor.diagram.locator("#Align-step-1-2").focus();
  await editor.page.keyboard.press("Enter");
  await editor.cursorIn(40);
  await editor.goTo(29, 6);
});

step("the diagram is readable in light, dark and high contrast", async () => {
  const themes = {
    light: "Light Modern",
    dark: "Dark Modern",
    "high-contrast": "Dark High Contrast",
    "high-contrast-light": "Light High Contrast",
  };
  for (const [name, theme] of Object.entries(themes)) {
    await editor.theme(theme);
    const body = editor.diagram.locator(`body.vscode-${name}`);
    await body.waitFor();
    const colours = await body.evaluate((element) => {
      const of = (selector, property) => getComputedStyle(element.querySelector(selector))[property];
      return [of(".fill-text", "fill"), getComputedStyle(element).backgroundColor, of(".fill-process", "fill")];
    });
    assert.equal(new Set(colours.slice(0, 2)).size, 2, `${theme}: ${colours}`);
    await editor.screenshot(`diagram-${name}`);
  }
  await editor.theme(themes.light);
});

step("while the text has mistakes in its syntax the last diagram stays", async () => {
  await editor.goTo(40, 3);
  await editor.page.keyboard.type(")");
  await editor.diagram.locator("#status", { hasText: "mistakes in its syntax" }).waitFor();
  await editor.diagram.locator(".stale #Align-velocity").waitFor();
  await editor.page.keyboard.press("Control+z");
  await editor.diagram.locator("#status").waitFor({ state: "hidden" });
});

step("a file with mistakes has a diagram of its own, not that of the file before", async () => {
  await editor.open("half.csp", 1, 10);
  await editor.diagram.locator("svg", { hasText: "process Good" }).waitFor();
  await editor.open("jiwy.csp", 29, 6);
  await editor.diagram.locator("#Align-velocity.lit").waitFor();
});

step("while a diagram is being drawn, that of the file before is paler, and is not exported", async () => {
  const drawers = editor.drawers();
  assert.equal(drawers.length, 1);
  for (const each of drawers) process.kill(each, "SIGSTOP");
  try {
    await editor.open("half.csp", 1, 10);
    await editor.diagram.locator("#status", { hasText: "The diagram is being drawn." }).waitFor();
    await editor.diagram.locator(".stale #Align-velocity").waitFor();
    await editor.diagram.locator("#export").click();
    await editor.notification("There is no diagram to export yet: it is being drawn.");
  } finally {
    for (const each of drawers) process.kill(each, "SIGCONT");
  }
  await editor.diagram.locator("svg", { hasText: "process Good" }).waitFor();
  await editor.diagram.locator("#status", { hasText: "is left out" }).waitFor();
  await editor.open("jiwy.csp", 29, 6);
  await editor.diagram.locator("#Align-velocity.lit").waitFor();
});

step("a file in which nothing can be drawn says why, under a title of its own", async () => {
  await editor.open("only.csp");
  await editor.diagram.locator("#status", { hasText: "the text has mistakes in its syntax, and without" }).waitFor();
  await editor.page.locator(".tab", { hasText: /^Diagram$/ }).waitFor();
  await editor.open("jiwy.csp", 29, 6);
  await editor.diagram.locator("#Align-velocity.lit").waitFor();
});

step("an element that was just written is lit and in view, also from the indentation of its line", async () => {
  const isInView = (id) =>
    editor.diagram.locator(`#${id}`).evaluate((element) => {
      const [own, room] = [element, document.getElementById("picture")].map((each) => each.getBoundingClientRect());
      return own.left > room.left - 2 && own.right < room.right + 2 && own.top > room.top - 2 && own.bottom < room.bottom + 2;
    });
  await editor.open("many.csp", 4, 5);
  await editor.diagram.locator("#Many-a0.lit").waitFor();
  for (let zoomed = 0; zoomed < 8; zoomed++) await editor.diagram.locator("#larger").click();
  await editor.goTo(4, 6);
  await editor.until(() => isInView("Many-a0"));
  await editor.goTo(17, 80);
  await editor.page.keyboard.press("Enter");
  await editor.page.keyboard.type("extra : Leaf");
  await editor.diagram.locator("#Many-extra.lit").waitFor();
  await editor.until(() => isInView("Many-extra"));
  assert.equal(await isInView("Many-a0"), false);
  await editor.goTo(4, 2);
  await editor.diagram.locator("#Many-a0.lit").waitFor();
  await editor.until(() => isInView("Many-a0"));
  await editor.diagram.locator("#fit").click();
  await editor.command("File: Revert File");
  await editor.open("jiwy.csp", 29, 6);
  await editor.diagram.locator("#Align-velocity.lit").waitFor();
});

step("a mistake is marked in the diagram as one types", async () => {
  await editor.goTo(32, 38);
  await editor.page.keyboard.type("x");
  await editor.diagram.locator(".fill-error").first().waitFor();
  await editor.page.keyboard.press("Control+z");
  await editor.diagram.locator(".fill-error").first().waitFor({ state: "detached" });
});

step("a server that is killed is started again, and that is said once", async () => {
  const [first] = editor.servers();
  process.kill(first, "SIGKILL");
  await editor.notification("ended by itself, and was started again");
  await editor.until(() => editor.servers().some((each) => each !== first));
  await editor.goTo(30, 7);
  await editor.diagram.locator("#Align-failed.lit").waitFor();
});

step("an environment is run and plotted where it is written", async () => {
  const line = readFileSync(path.join(MODELS, "jiwy/jiwy.csp"), "utf8").split("\n").findIndex((each) => /^environment/.test(each)) + 1;
  await editor.goTo(line);
  await editor.page.locator(".codelens-decoration a", { hasText: "Plot" }).first().click();
  await editor.page.locator(".tab", { hasText: "Bench.png" }).waitFor();
  await editor.page.locator(".codelens-decoration", { hasText: "ended by itself at 12.78 s" }).waitFor();
  await editor.screenshot("plot");
});

step("the diagram is as large as it was after a figure was in front of it", async () => {
  await editor.page.locator(".tab", { hasText: "Diagram of" }).click();
  await editor.diagram.locator("#larger").click();
  const width = await editor.diagram.locator("#picture > svg").getAttribute("width");
  await editor.page.locator(".tab", { hasText: "Bench.png" }).click();
  await editor.page.locator(".tab.active", { hasText: "Bench.png" }).waitFor();
  await editor.page.locator(".tab", { hasText: "Diagram of" }).click();
  await editor.page.locator(".tab.active", { hasText: "Diagram of" }).waitFor();
  assert.equal(await editor.diagram.locator("#picture > svg").getAttribute("width"), width);
  await editor.diagram.locator("#fit").click();
});

step("a run that fails is plotted, too", async () => {
  await editor.open("fault.csp", 6);
  await editor.page.locator(".codelens-decoration a", { hasText: "Plot" }).first().click();
  await editor.page.locator(".codelens-decoration", { hasText: "ended unsuccessfully at 0 s: Fault: division" }).waitFor();
  await editor.page.locator(".tab.active", { hasText: "Bench.png" }).waitFor();
  await editor.screenshot("plot-fault");
  await editor.open("wrong.csp", 6);
  await editor.page.locator(".codelens-decoration a", { hasText: "Plot" }).first().click();
  const without = await editor.notification("Bench has no figure: error[E0204]: there is no");
  await without.locator(".codicon-notifications-clear").click();
});

step("a proof that takes long is shown, and can be cancelled", async () => {
  await editor.open("slow.csp");
  await editor.goTo(SLOW.split("\n").length - 1);
  await editor.page.locator(".codelens-decoration a", { hasText: "Verify" }).click();
  const shown = await editor.notification("Verifying `assert Main deadlock free`");
  await editor.screenshot("verifying");
  await shown.locator("a.monaco-button", { hasText: "Cancel" }).click();
  await shown.waitFor({ state: "hidden" });
  await editor.page.locator(".codelens-decoration a", { hasText: /^Verify$/ }).waitFor();
});

step("a proof ends with the server, and its lens says so", async () => {
  await editor.open("slow.csp");
  await editor.goTo(SLOW.split("\n").length - 1);
  const ends = [
    () => editor.command("cspdiag: Restart Server"),
    () => editor.servers().forEach((each) => process.kill(each, "SIGKILL")),
  ];
  for (const end of ends) {
    await editor.page.locator(".codelens-decoration a", { hasText: "Verify" }).click();
    const shown = await editor.notification("Verifying `assert Main deadlock free`");
    await end();
    await shown.waitFor({ state: "hidden" });
    await editor.page.locator(".codelens-decoration a", { hasText: "Verify again (interrupted)" }).waitFor();
  }
  assert.equal(await editor.page.locator(".notification-list-item", { hasText: "Canceled" }).count(), 0);
});

step("the result of a run says that the text was changed while it ran", async () => {
  await editor.open("count.csp", 3);
  await editor.page.locator(".codelens-decoration a", { hasText: "Run" }).first().click();
  await editor.page.locator(".codelens-decoration", { hasText: "running…" }).waitFor();
  await editor.until(() => editor.runs().length === 1);
  // Another one takes its place.
  const before = editor.runs();
  await editor.page.locator(".codelens-decoration a", { hasText: "Run" }).first().click();
  await editor.until(() => editor.runs().length === 1 && editor.runs()[0] !== before[0]);
  await editor.page.locator(".codelens-decoration", { hasText: "running…" }).waitFor();
  const running = await editor.notification("Running Bench");
  await editor.goTo(1);
  await editor.page.keyboard.type(" ");
  await running.locator("a.monaco-button", { hasText: "Cancel" }).click();
  await editor.page.locator(".codelens-decoration", { hasText: "before the change: stopped" }).waitFor();
  await editor.page.locator(".monaco-editor").first().locator(".view-line").first().click();
  await editor.page.keyboard.press("Control+z");
  const current = editor.page.locator(".codelens-decoration", { hasText: /^Run.*Plot.*stopped$/ });
  await current.waitFor();
  // Also in a file that it imports.
  await editor.open("used.csp", 1);
  await editor.page.keyboard.type(" ");
  await editor.open("count.csp", 3);
  await editor.page.locator(".codelens-decoration", { hasText: "before the change: stopped" }).waitFor();
  await editor.open("used.csp", 1);
  await editor.page.keyboard.press("Control+z");
  await editor.open("count.csp", 3);
  await current.waitFor();
});

step("what a run complains of is shown while it runs", async () => {
  await editor.open("spin.csp", 13);
  await editor.page.locator(".codelens-decoration a", { hasText: "Run" }).first().click();
  const running = await editor.notification("Running Floor");
  await running.locator(".notification-list-item-message", { hasText: "simulated time stands still at 0 s" }).waitFor();
  await editor.screenshot("standstill");
  await editor.page.locator(".codelens-decoration a", { hasText: "running…" }).click();
  await editor.page.locator(".panel .view-line", { hasText: "simulated time stands still" }).first().waitFor();
  await editor.command("View: Toggle Panel Visibility");
  await editor.page.locator(".part.panel").waitFor({ state: "hidden" });
  await running.locator("a.monaco-button", { hasText: "Cancel" }).click();
  await editor.page.locator(".codelens-decoration", { hasText: "stopped" }).waitFor();
});

step("a counterexample is stepped through in the diagram", async () => {
  await editor.open("crossed.csp");
  await editor.goTo(12);
  await editor.page.locator(".codelens-decoration a", { hasText: "Verify" }).click();
  await editor.page.locator(".codelens-decoration a", { hasText: "Refuted" }).waitFor();
  await editor.page.locator(".codelens-decoration a", { hasText: "Step through" }).click();
  await editor.diagram.locator("#position", { hasText: "1/3" }).waitFor();
  await editor.diagram.locator('#previous[aria-disabled="true"]').waitFor();
  await editor.diagram.locator("#Main-left-a-right-a.communicating").waitFor();
  await editor.diagram.locator("#next").click();
  await editor.diagram.locator("#Main-right-b-left-b.communicating").waitFor();
  await editor.diagram.locator("#next").click();
  await editor.diagram.locator("#Main-right.waiting").waitFor();
  await editor.diagram.locator('#next[aria-disabled="true"]').waitFor();
  assert.equal(await editor.diagram.locator(".communicating").count(), 0);
  await editor.screenshot("counterexample");
  await editor.diagram.locator("#which").selectOption("composition");
  await editor.diagram.locator("#Main-left-a-right-a").waitFor({ state: "detached" });
  await editor.diagram.locator(".waiting", { hasText: "process right : Right" }).waitFor();
  await editor.diagram.locator("#previous").click();
  await editor.diagram.locator(".communicating", { hasText: "process left : Left" }).waitFor();
  await editor.screenshot("counterexample-composition");
  await editor.diagram.locator("#next").click();
  await editor.diagram.locator("#which").selectOption("both");
  await editor.diagram.locator("#process").selectOption("Left");
  await editor.diagram.locator("#step", { hasText: "This step is in the diagram of Main" }).waitFor();
  await editor.screenshot("counterexample-elsewhere");
  await editor.diagram.locator("#previous").click();
  await editor.diagram.locator("#Main-right-b-left-b.communicating").waitFor();
  await editor.diagram.locator("#leave").click();
  await editor.diagram.locator("#steps").waitFor({ state: "hidden" });
});

step("after a change the lens has the answer of before", async () => {
  await editor.open("crossed.csp", 1);
  await editor.page.keyboard.type("// hello\n");
  await editor.goTo(13);
  const lens = editor.page.locator(".codelens-decoration a", { hasText: "Verify again (refuted before the change:" });
  await lens.waitFor();
  await editor.screenshot("verify-again");
  const [start, end] = [await lens.boundingBox(), await editor.page.locator(".editor-instance").first().boundingBox()];
  assert.ok(start.x > end.x && start.x + start.width < end.x + end.width);
  for (let undone = 0; undone < 3; undone++) await editor.page.keyboard.press("Control+z");
  await editor.page.locator(".view-line", { hasText: "hello" }).waitFor({ state: "hidden" });
});

step("a text that is in no file yet is drawn as soon as it is one in CSP, and is saved and run", async () => {
  await editor.page.keyboard.press("Control+1");
  await editor.page.keyboard.press("F1");
  await editor.page.locator(".quick-input-widget input").fill(">File: New Untitled Text File");
  // Beside the command that compares two.
  await editor.page.locator('.quick-input-list .monaco-list-row[aria-label^="File: New Untitled Text File"]').click();
  await editor.page.locator(".tab.active", { hasText: "Untitled-1" }).waitFor();
  await editor.quickly(">Change Language Mode", "Change Language Mode");
  await editor.page.locator(".quick-input-list .monaco-list-row", { hasText: "Auto Detect" }).first().waitFor();
  await editor.page.locator(".quick-input-widget input").fill("CSP");
  await editor.page.locator(".quick-input-list .monaco-list-row.focused", { hasText: "CSP" }).waitFor();
  await editor.page.keyboard.press("Enter");
  await editor.page.keyboard.insertText("process Fresh { composition { wait 1 s } }\nenvironment Lone for Fresh { }\n");
  await editor.diagram.locator("svg", { hasText: "process Fresh" }).waitFor({ state: "attached" });
  await editor.page.locator(".codelens-decoration a", { hasText: "Run" }).first().click();
  const input = editor.page.locator(".quick-input-widget input").first();
  // The dialog writes the proposed name some time after it is there.
  await editor.until(async () => (await input.inputValue()).endsWith(".csp"));
  await input.fill(path.join(editor.folder, "fresh one.csp"));
  await editor.page.locator(".quick-input-widget a.monaco-button", { hasText: "OK" }).click();
  await editor.page.locator(".tab.active", { hasText: "fresh one.csp" }).waitFor();
  await editor.page.locator(".codelens-decoration", { hasText: "ended by itself at 1 s" }).waitFor();
});

step("an export is asked for another name if its ending is no format", async () => {
  const input = editor.page.locator(".quick-input-widget input").first();
  await editor.diagram.locator("#export").click();
  // The dialog writes the proposed name some time after it is there.
  await editor.until(async () => (await input.inputValue()).endsWith(".svg"));
  await input.fill(path.join(editor.folder, "odd.jpg"));
  await editor.page.locator(".quick-input-widget a.monaco-button", { hasText: "OK" }).click();
  const dialog = editor.page.locator(".monaco-dialog-box", { hasText: "has to be .svg, .png or .pdf" });
  await dialog.waitFor();
  await editor.screenshot("export-odd");
  await dialog.locator("a.monaco-button", { hasText: "Choose Another Name" }).click();
  await editor.until(async () => (await input.inputValue()).endsWith("/odd.svg"));
  await editor.page.locator(".quick-input-widget a.monaco-button", { hasText: "OK" }).click();
  await editor.until(() => existsSync(path.join(editor.folder, "odd.svg")));
  assert.ok(!existsSync(path.join(editor.folder, "odd.jpg")));
});

step("an export that fails says why", async () => {
  const input = editor.page.locator(".quick-input-widget input").first();
  await editor.diagram.locator("#export").click();
  await editor.until(async () => (await input.inputValue()).endsWith(".svg"));
  await input.fill("/proc/out.svg"); // Where nobody can write.
  await editor.page.locator(".quick-input-widget a.monaco-button", { hasText: "OK" }).click();
  await editor.notification("The diagram was not exported as out.svg:");
  await editor.screenshot("export-failed");
  await editor.command("Notifications: Clear All Notifications");
});

step("an example that is there already is not copied, but can be opened", async () => {
  await editor.command("cspdiag: Copy an Example…");
  const input = editor.page.locator(".quick-input-widget input");
  await editor.page.locator(".quick-input-list .monaco-list-row", { hasText: "dining" }).first().waitFor();
  await input.fill("dining");
  await editor.page.keyboard.press("Enter");
  const said = await editor.notification("Nothing was copied: there is a dining in my project #1 already.");
  await editor.screenshot("example-there");
  await said.locator("a.monaco-button", { hasText: "Open It" }).click();
  await editor.page.locator(".tab.active", { hasText: "dining.csp" }).waitFor();
});

step("the walkthrough knows what was done before it was opened", async () => {
  await editor.quickly(">Welcome: Open Walkthrough", "Open Walkthrough");
  await editor.page.locator(".quick-input-list .monaco-list-row", { hasText: "Get started with cspdiag" }).first().waitFor();
  await editor.page.locator(".quick-input-widget input").fill("Get started with cspdiag");
  await editor.page.keyboard.press("Enter");
  for (const each of ["install", "example", "diagram", "verify"]) {
    await editor.page.locator(`.getting-started-step[data-step-id$="${each}"][aria-checked="true"]`).waitFor();
  }
  await editor.screenshot("walkthrough");
  await editor.page.keyboard.press("Control+w");
  await editor.open("crossed.csp", 1);
});

step("the process that was chosen stays when the window is loaded again", async () => {
  await editor.diagram.locator("#process").selectOption("Right");
  await editor.diagram.locator("#which").selectOption("composition");
  await editor.diagram.locator("svg", { hasText: "composition of Right" }).waitFor();
  await editor.screenshot("before-reload");
  await editor.command("Developer: Reload Window");
  await editor.diagram.locator("svg", { hasText: "composition of Right" }).waitFor({ timeout: 60_000 });
  assert.equal(await editor.diagram.locator("#which").inputValue(), "composition");
  await editor.diagram.locator("#which").selectOption("both");
});

step("a file of ten megabytes says that it is not checked", async () => {
  await editor.open("large.csp");
  await editor.page.locator(".squiggly-info, .squiggly-hint, .squiggly-warning, .squiggly-error").first().waitFor();
});

step("a file that is not UTF-8, and one that is deleted while it is open", async () => {
  await editor.open("latin.csp");
  await editor.page.locator(".view-line", { hasText: "caf" }).waitFor();
  await editor.page.locator(".squiggly-error").first().waitFor();
  unlinkSync(path.join(editor.folder, "latin.csp"));
  await editor.open("slip.csp", 2, 20);
  await editor.page.locator(".squiggly-error").first().waitFor();
});

step("of several folders each has its own time for runs", async () => {
  const second = path.join(editor.root, "second");
  mkdirSync(path.join(second, ".vscode"), { recursive: true });
  writeFileSync(path.join(second, ".vscode/settings.json"), JSON.stringify({ "cspdiag.run.for": "3 s" }));
  writeFileSync(path.join(second, "idle.csp"), IDLE);
  writeFileSync(path.join(editor.folder, "idle.csp"), IDLE);
  await editor.openWorkspace([editor.folder, second]);
  for (const [folder, time] of [[second, "3 s"], [editor.folder, "20 s"]]) {
    await editor.open(path.join(folder, "idle.csp"), 1);
    await editor.page.locator(".codelens-decoration a", { hasText: "Run" }).first().click();
    await editor.page.locator(".codelens-decoration", { hasText: `reached the time limit at ${time}` }).waitFor();
  }
});
