import assert from "node:assert/strict";
import { test } from "node:test";
import { Pings } from "../../src/engine/pings";

function watched() {
  const said: (boolean | "ping")[] = [];
  return { said, pings: new Pings(() => said.push("ping"), (silent) => said.push(silent)) };
}

test("a ping without an answer for three seconds is silence, until something arrives", () => {
  const { said, pings } = watched();
  for (const now of [0, 1000, 2000, 3000, 4000]) pings.tick(now);
  assert.deepEqual(said, ["ping", true]);
  pings.heard();
  pings.tick(5000);
  assert.deepEqual(said, ["ping", true, false, "ping"]);
});

test("an interval that comes late, as in a page in the background, is no silence", () => {
  const { said, pings } = watched();
  for (const now of [0, 60_000, 120_000]) {
    pings.tick(now);
    pings.heard();
  }
  assert.deepEqual(said, ["ping", "ping", "ping"]);
});
