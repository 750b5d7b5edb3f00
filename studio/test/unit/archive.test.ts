import assert from "node:assert/strict";
import { test } from "node:test";
import { strFromU8, unzipSync } from "fflate";
import { archive } from "../../src/generate/archive";

const unpacked = (content: Uint8Array) => Object.entries(unzipSync(content)).map(([path, data]) => [path, strFromU8(data)]);

test("an archive has a folder of its own", () => {
  const { name, content, advice } = archive({ Makefile: "all:\n", "support/csp.h": "// ü\n" }, "pair", "c");
  assert.equal(name, "pair-c.zip");
  assert.deepEqual(unpacked(content), [["pair-c/Makefile", "all:\n"], ["pair-c/support/csp.h", "// ü\n"]]);
  assert.equal(advice, "");
});

test("an FMU is the archive itself, and it is said how it gets its binary", () => {
  const { name, content, advice } = archive({ "modelDescription.xml": "<a/>" }, "pair", "fmu");
  assert.equal(name, "pair.fmu");
  assert.deepEqual(unpacked(content), [["modelDescription.xml", "<a/>"]]);
  assert.match(advice, /`fmpy compile pair\.fmu`/);
});
