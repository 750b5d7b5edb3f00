import assert from "node:assert/strict";
import { test } from "node:test";
import { Counterexample } from "../../src/counterexample";

const part = (key: string) => ({ id: `id-${key}`, key, places: [], inside: null });
const picture = { name: "Main", svg: "", whole: true, parts: [part("left"), part("right")], definitions: [] };
const step = (process: string, text: string) => ({ process, text, communicating: ["left"], waiting: ["right", "other"] });

test("a step is shown by its elements in the diagram of its process, and named in another one", () => {
  const steps = new Counterexample([step("Main", "left.a 1"), step("Left", "wait")]);
  const shown = { type: "step", text: "left.a 1", position: "1/2", isFirst: true, isLast: false, communicating: ["id-left"], waiting: ["id-right"] };
  assert.deepEqual(steps.shownIn(picture), shown);
  steps.move(1);
  const elsewhere = { ...shown, text: "This step is in the diagram of Left: wait", position: "2/2", isFirst: false, isLast: true, communicating: [], waiting: [] };
  assert.deepEqual(steps.shownIn(picture), elsewhere);
});

test("steps end at the first and the last", () => {
  const steps = new Counterexample([step("Main", "one"), step("Main", "two")]);
  steps.move(-1);
  assert.equal(steps.step?.text, "one");
  steps.move(5);
  assert.equal(steps.step.text, "two");
  const none = new Counterexample();
  none.move(1);
  assert.equal(none.step, undefined);
});
