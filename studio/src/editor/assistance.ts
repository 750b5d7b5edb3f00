/** Completion, hover and definitions, as the engine knows them. */

import { type CompletionContext, type CompletionResult, snippetCompletion } from "@codemirror/autocomplete";
import type { Extension, Text } from "@codemirror/state";
import { EditorView, hoverTooltip } from "@codemirror/view";
import { language } from "./language";
import type { CompletionItem, Place, Position } from "../engine/messages";
import { markdown } from "../page/markdown";
import { offset, position } from "./places";

export interface Helper {
  complete: (file: string, at: Position) => Promise<CompletionItem[]>;
  hover: (file: string, at: Position) => Promise<string | undefined>;
  definition: (file: string, at: Position) => Promise<Place | undefined>;
  go: (place: Place) => void;
}

/** The kinds of the Language Server Protocol, as the editor's icons are named. */
const ICONS: Record<string, string> = {
  function: "function",
  keyword: "keyword",
  class: "class",
  struct: "class",
  enum: "enum",
  enummember: "constant",
  constant: "constant",
  field: "property",
  property: "property",
  variable: "variable",
  module: "namespace",
  interface: "interface",
  unit: "constant",
  snippet: "text",
};

/** The start of what a completion replaces: that of the word before the cursor, unless the engine says more. */
function beginning(items: readonly CompletionItem[], doc: Text, word: number): number {
  const start = items[0]?.start;
  return start == null ? word : offset(doc, start);
}

function completing(helper: Helper, file: () => string) {
  return async (context: CompletionContext): Promise<CompletionResult | null> => {
    const word = context.matchBefore(/[A-Za-z_][A-Za-z0-9_]*/);
    const after = context.matchBefore(/[.:<>!?]\s?|->\s?|\bimport\s/);
    if (word === null && after === null && !context.explicit) {
      return null;
    }
    const items = await helper.complete(file(), position(context.state.doc, context.pos));
    if (items.length === 0 || context.aborted) {
      return null;
    }
    return {
      from: beginning(items, context.state.doc, word?.from ?? context.pos),
      options: items.map((item) => {
        const { documentation } = item;
        const option = {
          label: item.label,
          type: ICONS[item.kind.toLowerCase()] ?? "text",
          ...(item.detail == null ? {} : { detail: item.detail }),
          ...(documentation == null ? {} : { info: () => markdown(documentation) }),
        };
        const insert = item.insert ?? item.label;
        return insert.includes("$") ? snippetCompletion(snippet(insert), option) : { ...option, apply: insert };
      }),
      validFor: /^[A-Za-z0-9_]*$/,
    };
  };
}

/** A snippet in the way of the editor: `${1:text}` is the same, `$1` and `$0` are written with braces. */
export function snippet(text: string): string {
  return text.replace(/\$(\d+)/g, (_, number: string) => (number === "0" ? "${}" : `\${${number}}`));
}

export function helping(helper: Helper, file: () => string, go: (place: Place) => void): Extension {
  const toDefinition = (view: EditorView, at: number) => {
    void helper.definition(file(), position(view.state.doc, at)).then((place) => {
      if (place !== undefined) {
        (place.file === file() ? go : helper.go)(place);
      }
    });
  };
  return [
    hoverTooltip(async (view, at) => {
      const text = await helper.hover(file(), position(view.state.doc, at));
      return text === undefined ? null : { pos: at, create: () => ({ dom: markdown(text, "hover") }) };
    }),
    language.data.of({ autocomplete: completing(helper, file) }),
    EditorView.domEventHandlers({
      mousedown(event, view) {
        const at = event.ctrlKey || event.metaKey ? view.posAtCoords({ x: event.clientX, y: event.clientY }) : null;
        if (at === null) {
          return false;
        }
        toDefinition(view, at);
        return true;
      },
      keydown(event, view) {
        if (event.key !== "F12") {
          return false;
        }
        toDefinition(view, view.state.selection.main.head);
        event.preventDefault();
        return true;
      },
    }),
  ];
}
