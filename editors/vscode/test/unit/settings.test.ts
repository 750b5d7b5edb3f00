import assert from "node:assert/strict";
import { test } from "node:test";
import { textOf } from "../../src/settings";

test("a setting of another type is what is written in the settings", () => {
  assert.equal(textOf("20 s"), "20 s");
  assert.equal(textOf(5), "5");
  assert.equal(textOf(["a"]), '["a"]');
  assert.equal(textOf(null), "null");
  assert.equal(textOf(undefined), "null");
});
