import assert from "node:assert/strict";
import { readFileSync, readdirSync } from "node:fs";
import { test } from "node:test";
import { StringStream } from "@codemirror/language";
import { parser } from "../../src/editor/language";

const MODELS = "../models";

/** Each token of a text with its style; spaces are left out. */
function tokens(text: string): [string, string | null][] {
  const state = parser.startState?.(2);
  assert.ok(state !== undefined);
  const found: [string, string | null][] = [];
  for (const line of text.split("\n")) {
    const stream = new StringStream(line, 2, 2);
    while (!stream.eol()) {
      stream.start = stream.pos;
      const style = parser.token(stream, state);
      if (stream.current().trim() !== "") {
        found.push([stream.current(), style]);
      }
    }
  }
  return found;
}

function models(): string[] {
  return readdirSync(MODELS, { recursive: true, encoding: "utf8" }).filter((name) => name.endsWith(".csp"));
}

test("every character of every model is known", () => {
  assert.ok(models().length > 10);
  for (const name of models()) {
    const unknown = tokens(readFileSync(`${MODELS}/${name}`, "utf8")).filter(([, style]) => style === "invalid");
    assert.deepEqual(unknown, [], name);
  }
});

test("every keyword of the grammar is coloured", () => {
  const grammar = readFileSync("../grammars/csp.lark", "utf8");
  const keywords = new Set([...grammar.matchAll(/"([a-z]+)"/g)].map((found) => found[1] ?? ""));
  assert.ok(keywords.size > 40);
  for (const word of keywords) {
    const style = tokens(word)[0]?.[1] ?? "";
    assert.match(style, /keyword|modifier|atom/i, word);
  }
});

test("names, units and durations are distinguished", () => {
  const found = new Map(tokens("process Law(kp: double<V/rad> = 4<V/rad>, T: time = 10 ms) // about"));
  assert.equal(found.get("process"), "definitionKeyword");
  assert.equal(found.get("Law"), "className");
  assert.equal(found.get("double"), "typeName");
  assert.equal(found.get("<V/rad>"), "unit");
  assert.equal(found.get(" ms"), "unit");
  assert.equal(found.get("// about"), "comment");
});

test("a keyword after a type is a keyword", () => {
  assert.deepEqual(tokens("a : int\n\ncommunication {").at(-2), ["communication", "definitionKeyword"]);
});

test("a comment over several lines ends where it ends", () => {
  assert.deepEqual(tokens("/* a\nb */ skip"), [
    ["/* a", "comment"],
    ["b */", "comment"],
    ["skip", "controlKeyword"],
  ]);
});
