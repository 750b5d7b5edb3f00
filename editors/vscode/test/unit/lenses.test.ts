import assert from "node:assert/strict";
import { test } from "node:test";
import { brief, outcome, titleOf } from "../../src/lenses";

test("a long title ends at a word, and is whole as the tooltip", () => {
  const title = "Refuted: `Main` can deadlock: after 2 steps, a process waits for something that never happens";
  const short = brief(title);
  assert.equal(short.title, "Refuted: `Main` can deadlock: after 2 steps, a…");
  assert.equal(short.tooltip, title);
  assert.deepEqual(brief("Verify"), { title: "Verify" });
  assert.equal(brief("x".repeat(200)).title, `${"x".repeat(47)}…`);
});

test("the outcome of a run does not name what the lens is at", () => {
  assert.equal(outcome("\nDiv in Fault: ended unsuccessfully at 0 s\n  more\n", "Fault", "20s", "/home/me/my kiln"), "ended unsuccessfully at 0 s");
  assert.equal(outcome("deadlock at 0 s: nothing happens\n", "Fault", "20s", "/home/me/my kiln"), "deadlock at 0 s: nothing happens");
  assert.equal(outcome("error[E0204]: there is no value `x in Fault: y`\n", "Fault", "20s", "/home/me/my kiln"), "error[E0204]: there is no value `x in Fault: y`");
  assert.equal(outcome("", "Fault", "20s", "/home/me/my kiln"), "ended without a word");
});

test("the outcome of a run begins with the reason, not with folders", () => {
  const said = outcome("cspdiag: /home/me/my kiln/kiln.csp: no such file\n", "Fault", "20s", "/home/me/my kiln");
  assert.equal(said, "kiln.csp: no such file");
});

test("a time that is refused is named with its setting", () => {
  const said = outcome("cspdiag: `abc` is not a time, such as 10 ms\n", "Fault", "abc", "/home/me/my kiln");
  assert.equal(said, "The setting cspdiag.run.for: `abc` is not a time, such as 10 ms");
  assert.match(outcome("cspdiag: a run cannot last -3s: write\n", "Fault", "-3s", "/home/me/my kiln"), /^The setting cspdiag.run.for: a run/);
  assert.equal(outcome("cspdiag: `abc` is not a time\n", "Fault", "20s", "/home/me/my kiln"), "`abc` is not a time");
});

test("the result of a run above a program that was not run says so", () => {
  const result = { program: "a1", outcome: "deadlock at 0 s" };
  assert.equal(titleOf(result, "a1"), "deadlock at 0 s");
  assert.equal(titleOf(result, "b2"), "before the change: deadlock at 0 s");
});
