import assert from "node:assert/strict";
import { test } from "node:test";
import SNIPPETS from "../../snippets/csp.json";
import { beginning } from "../../src/beginning";

test("a snippet begins with a word of the language, whatever documents it", () => {
  assert.equal(beginning("/// ${1:What it does.}\nprocess ${2:Name} {"), "process");
  assert.equal(beginning("assert ${1:Process} refines ${2:Specification}"), "assert");
  const words = Object.values(SNIPPETS).map(({ body }) => beginning(typeof body === "string" ? body : body.join("\n")));
  const expected = ["process", "submodel", "environment", "const", "parameter", "assert", "struct", "enum", "exception"];
  assert.deepEqual([...new Set(words)], expected);
});
