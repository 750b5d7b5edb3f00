import assert from "node:assert/strict";
import { test } from "node:test";
import type { Diagram, Part, Range } from "../../src/places";
import { definitionAt, partsAt, tellsMore } from "../../src/places";

function range(line: number, from: number, to: number, last = line): Range {
  return { start: { line, character: from }, end: { line: last, character: to } };
}

function part(id: string, ...ranges: Range[]): Part {
  return { id, key: id, inside: null, places: ranges.map((each) => ({ uri: "file:///a.csp", range: each })) };
}

const PARTS = [
  part("instance", range(3, 4, 20)),
  part("port", range(3, 4, 10), range(9, 0, 5)),
  part("arrow", range(3, 4, 10)),
  part("block", range(1, 0, 1, 12)),
];

function at(line: number, character: number, uri = "file:///a.csp"): string[] {
  return partsAt(PARTS, uri, { line, character }).map((found) => found.id);
}

test("the smallest place around the cursor counts, and all elements that have it", () => {
  assert.deepEqual(at(3, 6), ["port", "arrow"]);
  assert.deepEqual(at(3, 15), ["instance"]);
  assert.deepEqual(at(9, 5), ["port"]);
  assert.deepEqual(at(10, 0), ["block"]);
});

test("other files and places outside have no element", () => {
  assert.deepEqual(at(3, 6, "file:///b.csp"), []);
  assert.deepEqual(at(0, 0), []);
});

test("the definition around the cursor", () => {
  const definitions = [
    { name: "A", range: range(0, 0, 1, 5) },
    { name: "B", range: range(7, 0, 1, 9) },
  ];
  assert.equal(definitionAt(definitions, { line: 8, character: 0 }), "B");
  assert.equal(definitionAt(definitions, { line: 6, character: 0 }), undefined);
});

test("a picture of a text with mistakes replaces one that has some, too, or is not of the process that is wanted", () => {
  const of = (name: string, whole: boolean): Diagram => ({ name, whole, svg: "", parts: [], definitions: [] });
  assert.ok(tellsMore(of("Keeper", true), of("Keeper", false), "Keeper"));
  assert.ok(tellsMore(of("Keeper", true), of("Lock", false), "Keeper"));
  assert.ok(!tellsMore(of("Keeper", true), of("Chamber", false), "Chamber"));
  assert.ok(!tellsMore(of("Lock", false), of("Chamber", false), undefined));
  assert.ok(!tellsMore(of("Keeper", true), of("Keeper", true), "Keeper"));
  assert.ok(!tellsMore(undefined, of("Lock", false), undefined));
});
