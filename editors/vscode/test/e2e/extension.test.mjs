// The extension in an editor, as its user meets it.
import { after, before, test } from "node:test";
import { Editor } from "./editor.mjs";

const SLIP = "const period = 1 ms\nconst slow = 10 * peroid\n";

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
  editor = await Editor.start({ files: { "slip.csp": SLIP } });
});

after(() => editor.close());

step("a mistake is shown as a diagnostic", async () => {
  await editor.open("slip.csp");
  await editor.page.locator(".squiggly-error").first().waitFor();
  await editor.goTo(2, 20);
  await editor.command("View: Toggle Problems");
  await editor.page.locator(".markers-panel", { hasText: "there is no value `peroid`" }).waitFor();
  await editor.screenshot("slip");
});
