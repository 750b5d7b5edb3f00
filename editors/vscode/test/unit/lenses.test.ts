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
  assert.equal(outcome("\nDiv in Fault: ended unsuccessfully at 0 s\n  more\n", "Fault"), "ended unsuccessfully at 0 s");
  assert.equal(outcome("deadlock at 0 s: nothing happens\n", "Fault"), "deadlock at 0 s: nothing happens");
  assert.equal(outcome("error[E0204]: there is no value `x in Fault: y`\n", "Fault"), "error[E0204]: there is no value `x in Fault: y`");
  assert.equal(outcome("", "Fault"), "ended without a word");
});

test("the result of a run above a text that was not run says so", () => {
  const result = { text: "process A", outcome: "deadlock at 0 s" };
  assert.equal(titleOf(result, "process A"), "deadlock at 0 s");
  assert.equal(titleOf(result, "process B"), "before the change: deadlock at 0 s");
});
