import assert from "node:assert/strict";
import { test } from "node:test";
import { Lines } from "../../src/lines";

test("lines that come in pieces are whole", () => {
  const lines = new Lines();
  assert.deepEqual(lines.take("cspdiag: simulated time "), []);
  assert.deepEqual(lines.take("stands still\n\nBench in"), ["cspdiag: simulated time stands still", ""]);
  assert.deepEqual(lines.end(), ["Bench in"]);
  assert.deepEqual(lines.end(), []);
  assert.deepEqual(lines.take("one\ntwo\n"), ["one", "two"]);
  assert.deepEqual(lines.end(), []);
});
