import assert from "node:assert/strict";
import { test } from "node:test";
import { fetches } from "../../../editors/vscode/src/webview/picture";
import { snippet } from "../../src/editor/assistance";
import { Elements } from "../../src/diagram/elements";
import { scenes } from "../../src/proofs/film";
import { axes } from "../../src/run/hand";
import { bounds, duration } from "../../src/run/parameters";
import { colourOf, formula, pictureOf } from "../../src/run/plant";
import { around, groups, instant, named, round } from "../../src/run/plots";
import { text } from "../../src/run/value";
import { ring, sentence, summary } from "../../src/run/waits";

const signal = (name: string, type: string, hand = true) => ({ name, type, direction: "in", hand });

test("a formula is a signal with a factor and a summand", () => {
  assert.deepEqual(formula("angle"), { signal: "angle", factor: 1, summand: 0 });
  assert.deepEqual(formula("pan.angle * -57.3 + 10"), { signal: "pan.angle", factor: -57.3, summand: 10 });
  assert.deepEqual(formula("x - 2"), { signal: "x", factor: 1, summand: -2 });
  for (const wrong of ["", "2 * x", "x * y", "x; alert(1)", "x * 1e999x"]) {
    assert.equal(formula(wrong), undefined, wrong);
  }
});

test("a colour is that of the highest threshold that is reached", () => {
  const steps = "0: grey; 0.5: #c00; 1: var(--error)";
  assert.deepEqual([-1, 0, 0.7, 2].map((value) => colourOf(steps, value)), [undefined, "grey", "#c00", "var(--error)"]);
  assert.equal(colourOf("0: url(https://example.org)", 1), undefined);
});

test("what a picture may fetch is found, whatever way it is written", () => {
  for (const css of ["url(#shade)", "fill: url( '#shade' )", "rotate(3) scale(2)"]) {
    assert.equal(fetches(css), false, css);
  }
  const address = "http://elsewhere.test/k";
  for (const css of [`url(${address})`, `u\\72l(${address})`, `\\75 rl("${address}")`, `image-set("${address}" 1x)`, `url(#a), url(${address})`, `url("#a\\"${address}")`, `@import "${address}"`]) {
    assert.equal(fetches(css), true, css);
  }
});

test("the picture is named after the environment or the program", () => {
  const files = { "jiwy/a.csp": "", "jiwy/a.svg": "program", "jiwy/Bench.svg": "bench" };
  assert.equal(pictureOf({ files, main: "jiwy/a.csp" }, "Bench"), "bench");
  assert.equal(pictureOf({ files, main: "jiwy/a.csp" }, "Worn"), "program");
  assert.equal(pictureOf({ files: { "b.csp": "" }, main: "b.csp" }, "Bench"), undefined);
});

test("the stick takes the axes that are named like one", () => {
  const signals = [signal("gain", "double"), signal("stick_vertical", "double"), signal("stick_horizontal", "double")];
  assert.deepEqual(axes(signals), { x: "stick_horizontal", y: "stick_vertical" });
  assert.deepEqual(axes([signal("angle", "double<rad>"), signal("on", "bool")]), { x: "", y: "" });
  assert.deepEqual(axes([signal("free", "double", false)]), { x: "", y: "" });
});

test("signals with one unit share a plot", () => {
  const found = groups([signal("a", "double<rad>"), signal("b", "bool"), signal("c", "double<rad>"), signal("d", "double")]);
  assert.deepEqual(found.map((group) => [group.title, group.signals.length]), [["rad", 2], ["yes or no", 1], ["without unit", 1]]);
});

test("a plot has air, and a range without values", () => {
  assert.deepEqual(around(null, null), [-1, 1]);
  assert.deepEqual(around(0, 100), [-8, 108]);
  assert.deepEqual(around(0, 0), [-0.5, 0.5]);
});

test("an axis of names shows as many as there is room for", () => {
  const axis = (names: string[]) => named(names).values(undefined, named(names).splits());
  assert.deepEqual(axis(["false", "true"]), ["false", "true"]);
  assert.deepEqual(axis(["a", "b", "c", "emergency", "e", "f"]), ["a", "c", "e"]);
  assert.deepEqual(axis(["emergency"]), ["emerge…"]);
});

test("labels of whole numbers are whole", () => {
  assert.deepEqual(round(...around(3, 3, 1), 1), [2, 3, 4]);
  assert.deepEqual(round(...around(0, 1, 1), 1), [-1, 0, 1, 2]);
  assert.deepEqual(round(0, 37, 1), [0, 10, 20, 30]);
});

test("there are three numbers beside a plot, or a few more", () => {
  assert.deepEqual(round(-0.68, 0.75, 0), [-0.5, 0, 0.5]);
  assert.deepEqual(round(...around(0, 100), 0), [0, 50, 100]);
  for (let high = 0.1; high < 100; high *= 1.01) {
    const { length } = round(-0.03, high, 0);
    assert.ok(length >= 3 && length <= 6, `${high}: ${length}`);
  }
});

test("instants are short", () => {
  assert.deepEqual([0, 0.07, 12.5, 1.25e-6].map(instant), ["0", "0.07", "12.5", "1.25e-6"]);
});

test("values are written as the language builds them", () => {
  const value = { x: 0.1 + 0.2, on: true, list: [1, { y: "idle" }], none: null };
  assert.equal(text(value), "(x = 0.3, on = true, list = [1, (y = idle)], none = –)");
});

test("a slider goes around the value of the text", () => {
  assert.deepEqual([2, -2, 0].map(bounds), [[0, 4], [-4, 0], [-1, 1]]);
});

test("durations are read and written in units", () => {
  assert.deepEqual([0, 50_000_000, 9_000_000_000, 1500].map(duration), ["0 s", "50 ms", "9 s", "1.5 us"]);
});

test("what is inside an instance that is not unfolded lights the instance", () => {
  const elements = new Elements([
    { id: "1", kind: "process", name: "pan", path: "A.pan", definition: "Joint" },
    { id: "2", kind: "process", name: "cell", path: "A.cell", definition: "Cell" },
    { id: "3", kind: "channel", name: "k", channels: ["A.k"] },
  ]);
  assert.deepEqual(elements.named("A.pan.align.law"), ["1"]);
  assert.deepEqual(elements.named("A.cell[3]"), ["2"]);
  assert.deepEqual([...elements.everyNamed(["A.k", "B.x"])], ["3"]);
  assert.deepEqual(elements.search("JOINT"), ["1"]);
});

test("the cursor lights the smallest element around it", () => {
  const place = (line: number, end: number) => ({ file: "a.csp", start: { line, character: 0 }, end: { line: end, character: 9 } });
  const elements = new Elements([
    { id: "1", kind: "process", name: "a", places: [place(0, 9)] },
    { id: "2", kind: "process", name: "b", places: [place(3, 3)] },
  ]);
  assert.deepEqual(elements.at("a.csp", { line: 3, character: 2 }), ["2"]);
  assert.deepEqual(elements.at("a.csp", { line: 5, character: 2 }), ["1"]);
  assert.deepEqual(elements.at("b.csp", { line: 3, character: 2 }), []);
});

test("who waits is said in one sentence", () => {
  assert.equal(sentence({ process: "a", channels: [], for: "forever, at stop" }), "a waits forever, at stop");
  assert.equal(sentence({ process: "a", channels: [], for: "in an endless loop" }), "a is in an endless loop");
  assert.equal(sentence({ process: "a", channels: [], for: "ends its parallel branches" }), "a ends its parallel branches");
  assert.equal(sentence({ process: "a", channels: ["k"], for: "to read k", why: "; nobody writes" }), "a waits to read k; nobody writes");
  assert.equal(sentence({ process: "a", channels: ["k"], for: "waits to write" }), "a waits to write");
  assert.equal(sentence({ process: "a", channels: [] }), "a waits");
  assert.equal(sentence({ process: "a", channels: ["k"], for: "to read k", partners: ["b"] }), "a waits to read k, for b");
  assert.equal(sentence({ process: "a", channels: ["k"], for: "waits to write k", partners: ["b"] }), "a waits to write k, for b");
});

test("the ring of a deadlock is said in one sentence, with those who wait beside it", () => {
  const waits = (process: string, ...partners: string[]) => ({ process, channels: [], partners });
  const table = [waits("guest", "a"), waits("a", "left"), waits("left", "b"), waits("b", "right"), waits("right", "a")];
  assert.deepEqual(ring(table), ["a", "left", "b", "right"]);
  assert.equal(summary(table), "In a ring each waits for the next: a, left, b, right, and that again for a; beside them guest waits, too.");
  assert.equal(summary([waits("a", "gone", "b"), waits("b", "a")]), "a and b wait for each other.");
  assert.equal(summary([waits("a", "b"), waits("b", "c"), waits("d")]), "");
});

test("a film ends with who waits", () => {
  const waiting = [{ process: "a", channels: [] }];
  assert.deepEqual(scenes({ steps: [{ text: "one" }], final: { text: "stuck", waiting } }), [{ text: "one" }, { text: "stuck", waiting }]);
  assert.deepEqual(scenes({ steps: [{ text: "one" }], final: null }), [{ text: "one" }]);
});

test("snippets are written as the editor has them", () => {
  assert.equal(snippet("process $1 {\n  ${2:body}\n}$0"), "process ${1} {\n  ${2:body}\n}${}");
});
