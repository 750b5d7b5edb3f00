// Without a cspdiag that can be started: what the user is told, and offered, until it is mended.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { Editor } from "./editor.mjs";

/** @type {Editor} */
let editor;

before(async () => {
  editor = await Editor.start({ files: { "slip.csp": "const a = b\n" }, withCspdiag: false, trusted: false });
});

after(() => editor.close());

test("in a folder that is not trusted, that is said, and trust is offered", async () => {
  editor.install("venv");
  await editor.open("slip.csp");
  const said = await editor.notification("This folder is not trusted");
  await editor.screenshot("untrusted");
  await editor.command("cspdiag: Show the Diagram beside the Text");
  await editor.diagram.locator("#status", { hasText: "This folder is not trusted" }).waitFor();
  editor.uninstall("venv");
  await said.locator("a", { hasText: "Manage Workspace Trust" }).click();
  await editor.page.locator(".workspace-trust-editor a", { hasText: /^Trust$/ }).click();
  await said.waitFor({ state: "hidden" });
});

test("cspdiag is offered, and what would run is said before it runs", async () => {
  const offer = await editor.notification("cspdiag is not installed here");
  await editor.screenshot("missing");
  await offer.locator("a", { hasText: "Install" }).click();
  const dialog = editor.page.locator(".monaco-dialog-box");
  await dialog.waitFor();
  const said = await dialog.innerText();
  assert.match(said, /python3 -m venv .*\/project\/\.venv/);
  assert.match(said, /pip install --upgrade "cspdiag\[lsp,draw,plot,verify\]"/);
  await dialog.locator("a.monaco-button", { hasText: "Cancel" }).click();
  await dialog.waitFor({ state: "hidden" });
});

test("an installation that fails says what failed, and cspdiag is still offered", async () => {
  await editor.page.locator(".statusbar-item", { hasText: "cspdiag" }).click();
  const offer = await editor.notification("cspdiag is not installed here");
  await offer.locator("a", { hasText: "Install" }).click();
  await editor.page.locator(".monaco-dialog-box a.monaco-button", { hasText: /^Install$/ }).click();
  const failed = await editor.notification(/cspdiag was not installed: (venv|pip) failed, see the terminal/);
  await editor.screenshot("install-failed");
  await failed.locator(".codicon-notifications-clear").click();
  await editor.page.locator(".statusbar-item", { hasText: "cspdiag" }).waitFor();
});

test("what a setting names is said with its whole path, until it is mended", async () => {
  editor.settings({ "cspdiag.path": "${workspaceFolder}/none/bin/cspdiag" });
  const first = await editor.notification(`There is no file ${editor.folder}/none/bin/cspdiag`);
  editor.settings({ "cspdiag.path": ".vscode" });
  await editor.notification(`${editor.folder}/.vscode, which the setting cspdiag.path names, is a folder`);
  await first.waitFor({ state: "hidden" });
  editor.program("hangs", "#!/bin/sh\nexec sleep 60\n");
  editor.settings({ "cspdiag.path": "hangs" });
  const asked = await editor.notification(`${editor.folder}/hangs is being asked for its version`);
  editor.settings({ "cspdiag.path": "tools/bin/cspdiag" });
  const second = await editor.notification(`There is no file ${editor.folder}/tools/bin/cspdiag`);
  await asked.waitFor({ state: "hidden" });
  editor.install("tools");
  await second.locator("a", { hasText: "Try Again" }).click();
  await second.waitFor({ state: "hidden" });
  await editor.open("slip.csp");
  await editor.page.locator(".squiggly-error").first().waitFor();
  await editor.page.locator(".statusbar-item", { hasText: "cspdiag" }).waitFor({ state: "hidden" });
});
