/** How the language is coloured: words by what they are, names by what they stand for. */

import { HighlightStyle, StreamLanguage, type StreamParser, type StringStream } from "@codemirror/language";
import { tags } from "@lezer/highlight";

function words(text: string): Set<string> {
  return new Set(text.split(" "));
}

/** The keywords that begin or name a definition. */
const DEFINITIONS = words(
  "const parameter type enum struct exception process submodel driver environment var channel communication composition import assert",
);
const CONTROL = words(
  "if then else mu until while do for seq par pripar alt prialt catch raise interrupt when after at wait reset skip stop",
);
const MODIFIERS = words(
  "in out sync broadcast any buffer overwrite immediate offset safe let state next der wcet step method on miss place " +
    "deadlock livelock free terminates schedulable refines failures hide and or not device fmu",
);
const TYPES = words("bool double float int int8 int16 int32 uint8 uint16 uint32 time");
const FUNCTIONS = words(
  "abs acos asin atan atan2 ceil convert cos exp floor limit log max min quantize round sign sin sqrt tan",
);
const CONSTANTS = words("true false pi");

const NUMBER = /^\d+(?:\.\d+)?(?:[eE][+-]?\d+)?/;
const UNIT = /^<[A-Za-z0-9_/*^.-]+>/;
const DURATION = /^[ \t]*(?:ns|us|ms|s|min|Hz|kHz|MHz)(?![A-Za-z0-9_])/;
const NAME = /^[A-Za-z_][A-Za-z0-9_]*/;
const OPERATOR = /^(?:->|:=|\|\|>?|\[\]>?|==|!=|<=|>=|[?!;&@=<>+\-*/%^|])/;

interface State {
  comment: boolean;
  /** What was before the present token, which tells what a name is. */
  before: string;
}

function name(stream: StringStream, word: string, state: State): string {
  const before = state.before;
  state.before = word;
  if (before === ".") {
    return "propertyName";
  }
  if (CONSTANTS.has(word)) {
    return "atom";
  }
  if (/^(?:process|submodel|driver|environment|type|enum|struct|exception|assert|catch|raise|refines|hide)$/.test(before)) {
    return /^(?:deadlock|livelock|terminates|schedulable|refines)$/.test(word) ? "modifier" : "className";
  }
  if (DEFINITIONS.has(word)) {
    return "definitionKeyword";
  }
  if (CONTROL.has(word)) {
    return "controlKeyword";
  }
  if (MODIFIERS.has(word)) {
    return "modifier";
  }
  if (TYPES.has(word)) {
    state.before = "a type";
    return "typeName";
  }
  if (stream.match(/^(?=\()/, false) !== null && FUNCTIONS.has(word)) {
    return "function";
  }
  return /^[A-Z][A-Za-z]*[a-z]/.test(word) ? "className" : "variableName";
}

function comment(stream: StringStream, state: State): string {
  if (stream.skipTo("*/")) {
    stream.match("*/");
    state.comment = false;
  } else {
    stream.skipToEnd();
  }
  return "comment";
}

export const parser: StreamParser<State> = {
  name: "csp",
  startState: () => ({ comment: false, before: "" }),
  token(stream, state) {
    if (state.comment) {
      return comment(stream, state);
    }
    if (state.before === "duration" && stream.match(DURATION) !== null) {
      state.before = "unit";
      return "unit";
    }
    if (stream.eatSpace()) {
      return null;
    }
    if (stream.match("//") === true) {
      const doc = stream.peek() === "/";
      stream.skipToEnd();
      return doc ? "docComment" : "comment";
    }
    if (stream.match("/*") === true) {
      state.comment = true;
      return comment(stream, state);
    }
    if (stream.match(/^"[^"]*"?/) !== null) {
      return "string";
    }
    if (stream.match(NUMBER) !== null) {
      state.before = stream.match(DURATION, false) === null ? "number" : "duration";
      return "number";
    }
    if (/^(?:number|a type)$/.test(state.before) && stream.match(UNIT) !== null) {
      state.before = "unit";
      return "unit";
    }
    const word = stream.match(NAME);
    if (typeof word === "object" && word !== null) {
      return name(stream, word[0], state);
    }
    state.before = stream.peek() ?? "";
    if (stream.match(OPERATOR) !== null) {
      return "operator";
    }
    if (stream.match(/^[(){}[\],:.]/) !== null) {
      return "punctuation";
    }
    stream.next();
    return "invalid";
  },
  languageData: { commentTokens: { line: "//", block: { open: "/*", close: "*/" } }, indentOnInput: /^\s*\}$/ },
  tokenTable: { function: tags.standard(tags.variableName), unit: tags.unit, docComment: tags.docComment },
};

export const language = StreamLanguage.define(parser);

/** Whether a file is in this language, and not in another one or a picture. */
export function isProgram(file: string): boolean {
  return file.endsWith(".csp");
}

export const colours = HighlightStyle.define([
  { tag: [tags.comment], color: "var(--faint)", fontStyle: "italic" },
  { tag: tags.docComment, color: "var(--doc)" },
  { tag: tags.string, color: "var(--string)" },
  { tag: tags.number, color: "var(--number)" },
  { tag: tags.atom, color: "var(--number)" },
  { tag: tags.unit, color: "var(--unit)" },
  { tag: [tags.definitionKeyword], color: "var(--keyword)", fontWeight: "600" },
  { tag: [tags.controlKeyword, tags.modifier], color: "var(--keyword)" },
  { tag: [tags.typeName, tags.standard(tags.variableName)], color: "var(--type)" },
  { tag: tags.className, color: "var(--class)" },
  { tag: tags.operator, color: "var(--operator)" },
  { tag: tags.invalid, color: "var(--error)" },
]);
