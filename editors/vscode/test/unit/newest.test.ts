import assert from "node:assert/strict";
import { test } from "node:test";
import { Newest } from "../../src/newest";

test("what is begun later takes the place of what was begun before under the same key", () => {
  const runs = new Newest();
  const [first, other, second] = [runs.begin("a.csp A"), runs.begin("a.csp B"), runs.begin("a.csp A")];
  assert.ok(first.signal.aborted);
  assert.ok(!other.signal.aborted && !second.signal.aborted);
  assert.ok(!runs.end("a.csp A", first));
  assert.ok(runs.end("a.csp A", second));
  assert.ok(!runs.begin("a.csp A").signal.aborted);
  assert.ok(!second.signal.aborted);
});

test("what was stopped is still the newest, unless all were ended", () => {
  const runs = new Newest();
  const stopped = runs.begin("a.csp A");
  stopped.abort();
  assert.ok(runs.end("a.csp A", stopped));
  const ended = runs.begin("a.csp A");
  runs.endAll();
  assert.ok(ended.signal.aborted);
  assert.ok(!runs.end("a.csp A", ended));
});
