import assert from "node:assert/strict";
import { test } from "node:test";
import { Restarts } from "../../src/restarts";

test("a server that ends is started again, which is said once", () => {
  const restarts = new Restarts(() => 0);
  assert.deepEqual(restarts.ended(), { again: true, say: true });
  assert.deepEqual(restarts.ended(), { again: true, say: false });
});

test("a server that keeps ending is given up", () => {
  let now = 0;
  const restarts = new Restarts(() => now);
  const answers = [1, 2, 3, 4, 5].map(() => restarts.ended().again);
  assert.deepEqual(answers, [true, true, true, true, false]);
  now += 10 * 60_000;
  assert.equal(restarts.ended().again, true);
});
