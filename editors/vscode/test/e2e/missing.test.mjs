// Without cspdiag: what the user is told, and offered.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { Editor } from "./editor.mjs";

/** @type {Editor} */
let editor;

before(async () => {
  editor = await Editor.start({ files: { "slip.csp": "const a = b\n" }, withCspdiag: false });
});

after(() => editor.close());

test("cspdiag is offered, and what would run is said before it runs", async () => {
  await editor.open("slip.csp");
  const offer = await editor.notification("cspdiag is not installed here");
  await offer.locator("a.monaco-button", { hasText: "Install" }).click();
  const dialog = editor.page.locator(".monaco-dialog-box");
  await dialog.waitFor();
  const said = await dialog.innerText();
  assert.match(said, /python3 -m venv .*\/project\/\.venv/);
  assert.match(said, /pip install --upgrade "cspdiag\[lsp,draw,plot,verify\]"/);
  await dialog.locator("a.monaco-button", { hasText: "Cancel" }).click();
  await dialog.waitFor({ state: "hidden" });
});
