import assert from "node:assert/strict";
import { test } from "node:test";
import { Lanes } from "../../src/run/lanes";

/** Lanes after what was entered at some instants, and left where the name has a minus before it. */
function lanes(...happened: [t: number, name: string][]): Lanes {
  const made = new Lanes();
  for (const [t, name] of happened) {
    const mode = name.replace("-", "");
    made.add({ t, group: "A", path: `A.${mode}`, mode: name.startsWith("-") ? null : mode });
  }
  return made;
}

/** Each lane as a text. */
const shown = (made: Lanes, from = 0, to = 100) =>
  made.lanes.map((_, lane) => made.spans(lane, from, to, 90).map((span) => `${span.mode} ${span.from}-${span.to}`).join(", "));

test("modes one after the other are in one lane, whether a process ends before or after the next one begins", () => {
  const made = lanes([0, "one"], [40, "two"], [40, "-one"], [60, "-two"], [60, "three"], [80, "-three"]);
  assert.deepEqual(shown(made), ["one 0-40, two 40-60, three 60-80"]);
  assert.deepEqual([0, 39, 40, 60, 80].map((at) => made.at(0, at)), ["one", "one", "two", "three", undefined]);
  assert.deepEqual(shown(made, 30, 50), ["one 30-40, two 40-50"]);
});

test("modes at the same time are beside each other, and stay there", () => {
  const made = lanes([0, "trolley"], [0, "hoist"], [50, "-trolley"], [60, "-hoist"], [70, "hoist"], [70, "trolley"]);
  assert.deepEqual(shown(made), ["trolley 0-50, trolley 70-90", "hoist 0-60, hoist 70-90"]);
  assert.deepEqual([55, 65].map((at) => [made.at(0, at), made.at(1, at)]), [[undefined, "hoist"], [undefined, undefined]]);
});

test("a mode that is entered again and again is one, and its beginning is kept", () => {
  const made = lanes(...Array.from({ length: 20 }, (_, k): [number, string][] => [[5 * k, "go"], [5 * k + 5, "-go"]]).flat());
  assert.deepEqual(shown(made), ["go 0-90"]);
  const gaps = lanes(...Array.from({ length: 3000 }, (_, k): [number, string][] => [[10 * k, "go"], [10 * k + 1, "-go"]]).flat());
  assert.deepEqual(gaps.spans(0, 0, 30_000, 30_000).map(({ from, to }) => [from, to]), [[0, 29_991]]);
  assert.equal(gaps.spans(0, 0, 100, 30_000).length, 11);
});
