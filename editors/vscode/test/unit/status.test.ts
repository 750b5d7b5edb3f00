import assert from "node:assert/strict";
import { mock, test } from "node:test";
import { BEING_DRAWN, Status } from "../../src/status";

test("a picture of something else is soon said to be drawn, one of an earlier text later, and neither if it is there", () => {
  mock.timers.enable({ apis: ["setTimeout"] });
  try {
    const said: [string, boolean][] = [];
    const status = new Status((...each) => said.push(each));
    status.wait("elsewhere");
    mock.timers.tick(100);
    status.say("", false);
    mock.timers.tick(10_000);
    assert.deepEqual(said, [["", false]]);
    status.wait("changed");
    mock.timers.tick(1_000);
    assert.equal(said.length, 1);
    status.wait("elsewhere");
    mock.timers.tick(500);
    assert.deepEqual(said[1], [BEING_DRAWN, true]);
  } finally {
    mock.timers.reset();
  }
});

test("why there is nothing to export is what was said, if that is a reason", () => {
  const status = new Status(() => undefined);
  assert.match(status.whyNone, /yet: it is being drawn/);
  status.say("There is no diagram: there is no process to draw.", false);
  assert.match(status.whyNone, /no process to draw/);
  status.forget();
  assert.match(status.whyNone, /yet: it is being drawn/);
});
