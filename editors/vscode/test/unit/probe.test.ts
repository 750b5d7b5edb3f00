import assert from "node:assert/strict";
import { test } from "node:test";
import type { Ended } from "../../src/probe";
import { isOlder, problemOf, run } from "../../src/probe";

const FINE: Ended = { status: 0, output: "", errors: "" };

function says(version: Ended, server: Ended) {
  return problemOf("/bin/cspdiag", (_, args) => Promise.resolve(args[0] === "lsp" ? server : version));
}

const OF_TODAY: Ended = { ...FINE, output: "cspdiag 0.1.0\n" };

test("a cspdiag that serves has no problem", async () => {
  assert.equal(await says(OF_TODAY, FINE), undefined);
});

test("one that is too old is named with its version", async () => {
  const old = await says({ ...FINE, output: "cspdiag 0.0.9\n" }, FINE);
  assert.equal(old?.message, "/bin/cspdiag is version 0.0.9, and this extension needs 0.1.0 or newer");
  assert.equal(old.update, true);
  const withoutVerb = await says(OF_TODAY, { status: 2, output: "", errors: "cspdiag: unknown verb 'lsp'\n" });
  assert.match(withoutVerb?.message ?? "", /too old: it has no language server/);
});

test("one without the extra is named", async () => {
  const errors = "cspdiag: this needs pygls: pip install 'cspdiag[lsp]'\n";
  const problem = await says(OF_TODAY, { status: 2, output: "", errors });
  assert.equal(problem?.message, "/bin/cspdiag was installed without its language server");
  assert.equal(problem.update, true);
});

test("one that does not start says what it says", async () => {
  const problem = await says({ status: 1, output: "", errors: "Traceback\nImportError: lark\n" }, FINE);
  assert.deepEqual(problem, { message: "/bin/cspdiag does not start: ImportError: lark", update: false });
});

test("a file that is no program is a problem, too", async () => {
  const problem = await problemOf("/dev/null/cspdiag", run);
  assert.match(problem?.message ?? "", /^\/dev\/null\/cspdiag does not start: /);
});

test("one that does not answer is given up, and that is said", async () => {
  const ended = await run(process.execPath, ["-e", "setTimeout(() => 0, 60000)"], undefined, 0.05);
  assert.equal(ended.late, true);
  const problem = await problemOf("/bin/cspdiag", () => Promise.resolve(ended));
  assert.equal(problem?.message, "/bin/cspdiag did not answer within 20 s");
});

test("versions are compared as numbers", () => {
  assert.ok(isOlder("0.9.10", "0.10.0"));
  assert.ok(isOlder("0.1", "0.1.1"));
  assert.ok(!isOlder("1.0", "1.0.0"));
  assert.ok(!isOlder("0.10.0", "0.9.10"));
});
