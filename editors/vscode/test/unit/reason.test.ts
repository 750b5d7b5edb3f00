import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { test } from "node:test";
import { reasonOf } from "../../src/reason";

test("the reason of a failure is without names of classes, calls and programs", async () => {
  const refused = "NoPermissions (FileSystem): Error: EROFS: read-only file system, open '/tmp/ro/out.svg'";
  assert.equal(reasonOf(new Error(refused)), "read-only file system");
  assert.equal(reasonOf(new Error("cspdiag: there is no example `dinner`\n")), "there is no example `dinner`");
  assert.equal(reasonOf("TypeError: x is undefined"), "x is undefined");
  await assert.rejects(readFile("/no/such/file"), (problem) => reasonOf(problem) === "no such file or directory");
});
