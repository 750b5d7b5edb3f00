import assert from "node:assert/strict";
import { test } from "node:test";
import { brief, complaintDuring, lastComplaint, outcome, titleOf } from "../../src/lenses";

const FOLDER = "/home/me/my kiln";

function said(errors: string, environment: string, time: string): string {
  return outcome({ errors, signal: null }, environment, time, FOLDER);
}

test("a long title ends at a word, and is whole as the tooltip", () => {
  const title = "Refuted: `Main` can deadlock: after 2 steps, a process waits for something that never happens";
  const short = brief(title);
  assert.equal(short.title, "Refuted: `Main` can deadlock: after 2 steps, a…");
  assert.equal(short.tooltip, title);
  assert.deepEqual(brief("Verify"), { title: "Verify" });
  assert.equal(brief("x".repeat(200)).title, `${"x".repeat(47)}…`);
});

test("the outcome of a run does not name what the lens is at", () => {
  assert.equal(said("\nDiv in Fault: ended unsuccessfully at 0 s\n  more\n", "Fault", "20s"), "ended unsuccessfully at 0 s");
  assert.equal(said("deadlock at 0 s: nothing happens\n", "Fault", "20s"), "deadlock at 0 s: nothing happens");
  assert.equal(said("error[E0204]: there is no value `x in Fault: y`\n", "Fault", "20s"), "error[E0204]: there is no value `x in Fault: y`");
  assert.equal(said("", "Fault", "20s"), "ended without a word");
});

test("the outcome of a run is how it ended, whatever was printed before", () => {
  const warned = "warning[W0616]: `stop` comes when it becomes true\n --> crane.csp:3:4\n\n";
  assert.equal(said(`${warned}Crane in Yard: reached the time limit at 20 s\n  missed samples: none\n`, "Yard", "20s"), "reached the time limit at 20 s");
  assert.equal(said(`${warned}error[E0204]: there is no \`x\`\n`, "Yard", "20s"), "error[E0204]: there is no `x`");
  assert.equal(said(`${warned}cspdiag: Yard has a device in C\n  write --target c\n`, "Yard", "20s"), "Yard has a device in C");
  const printed = "Crane in Yard: hello\nOther in Hall: hello\nCrane in Yard: ended by itself at 2 s\n";
  assert.equal(said(printed, "Yard", "20s"), "ended by itself at 2 s");
  const deadlock = "deadlock at 2 s: 2 processes wait for each other\n  a waits\nCrane in Yard: deadlock at 2 s\n";
  assert.equal(said(warned + deadlock, "Yard", "20s"), "deadlock at 2 s: 2 processes wait for each other");
  assert.equal(lastComplaint(["cspdiag: run.png: no space left", "Crane in Yard: ended by itself at 2 s"]), "run.png: no space left");
  assert.equal(outcome({ errors: warned, signal: "SIGSEGV" }, "Yard", "20s", FOLDER), "ended by SIGSEGV");
});

test("the outcome of a run begins with the reason, not with folders", () => {
  const reason = said("cspdiag: /home/me/my kiln/kiln.csp: no such file\n", "Fault", "20s");
  assert.equal(reason, "kiln.csp: no such file");
});

test("a time that is refused is named with its setting", () => {
  const reason = said("cspdiag: `abc` is not a time, such as 10 ms\n", "Fault", "abc");
  assert.equal(reason, "The setting cspdiag.run.for: `abc` is not a time, such as 10 ms");
  assert.match(said("cspdiag: a run cannot last -3s: write\n", "Fault", "-3s"), /^The setting cspdiag.run.for: a run/);
  assert.equal(said("cspdiag: `abc` is not a time\n", "Fault", "20s"), "`abc` is not a time");
});

test("the result of a run above a program that was not run says so", () => {
  const result = { program: "a1", outcome: "deadlock at 0 s" };
  assert.equal(titleOf(result, "a1"), "deadlock at 0 s");
  assert.equal(titleOf(result, "b2"), "before the change: deadlock at 0 s");
});

test("what a command complains of while it runs is shown beside the button that cancels it", () => {
  const still = "cspdiag: simulated time stands still at 0 s; at work: `n := 1` (/home/me/my kiln/kiln.csp:2): Ctrl-C ends the run, and verify shows it";
  assert.equal(complaintDuring([still], FOLDER), "simulated time stands still at 0 s; at work: `n := 1` (kiln.csp:2): Cancel ends the run, and verify shows it");
  assert.equal(complaintDuring(["warning[W0616]: `stop` comes when it becomes true", " --> crane.csp:3:4"], FOLDER), undefined);
});
