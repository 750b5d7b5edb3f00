/** The editor of the program's text. */

import { autocompletion, closeBrackets, closeBracketsKeymap, completionKeymap } from "@codemirror/autocomplete";
import { defaultKeymap, history, historyKeymap, indentWithTab } from "@codemirror/commands";
import { bracketMatching, foldGutter, foldKeymap, indentUnit, syntaxHighlighting } from "@codemirror/language";
import { type Diagnostic, lintGutter, lintKeymap, setDiagnostics } from "@codemirror/lint";
import { highlightSelectionMatches, searchKeymap } from "@codemirror/search";
import { EditorSelection, EditorState, type Extension, Transaction } from "@codemirror/state";
import {
  EditorView,
  drawSelection,
  highlightActiveLine,
  highlightActiveLineGutter,
  highlightSpecialChars,
  keymap,
  lineNumbers,
} from "@codemirror/view";
import type { Edit, Finding, Fix, Place, Position } from "../engine/messages";
import { h } from "../page/dom";
import { inline } from "../page/markdown";
import { type Helper, helping } from "./assistance";
import { colours, isProgram, language } from "./language";
import { offset, position } from "./places";

export interface Listener extends Helper {
  changed: (file: string, text: string) => void;
  cursor: (file: string, at: Position) => void;
  fix: (fix: Fix) => void;
  format: () => void;
}

export class Editor {
  private readonly view: EditorView;
  private readonly states = new Map<string, EditorState>();
  private findings: readonly Finding[] = [];
  private file = "";
  private readonly extensions: Extension;
  /** What is known of the language of programs. */
  private readonly help: Extension;

  constructor(
    parent: HTMLElement,
    private readonly listener: Listener,
  ) {
    this.extensions = [
      EditorView.cspNonce.of(document.querySelector<HTMLMetaElement>("meta[name=nonce]")?.content ?? ""),
      lineNumbers(),
      highlightActiveLineGutter(),
      highlightSpecialChars(),
      history(),
      foldGutter(),
      drawSelection(),
      EditorState.allowMultipleSelections.of(true),
      EditorState.tabSize.of(2),
      indentUnit.of("  "),
      syntaxHighlighting(colours),
      bracketMatching(),
      closeBrackets(),
      highlightActiveLine(),
      highlightSelectionMatches(),
      lintGutter(),
      keymap.of([
        { key: "Shift-Alt-f", run: () => (listener.format(), true) },
        ...closeBracketsKeymap,
        ...defaultKeymap,
        ...searchKeymap,
        ...historyKeymap,
        ...foldKeymap,
        ...completionKeymap,
        ...lintKeymap,
        indentWithTab,
      ]),
      EditorView.contentAttributes.of({ "aria-label": "Text of the program", spellcheck: "false" }),
      EditorView.updateListener.of((update) => {
        if (update.docChanged) {
          listener.changed(this.file, update.state.doc.toString());
        }
        if (update.docChanged || update.selectionSet) {
          listener.cursor(this.file, position(update.state.doc, update.state.selection.main.head));
        }
      }),
    ];
    this.help = [language, autocompletion(), helping(listener, () => this.file, (place) => this.goTo(place))];
    this.view = new EditorView({ parent, extensions: this.extensions });
  }

  /** Forgets all files. */
  clear(): void {
    this.states.clear();
    this.file = "";
    this.findings = [];
  }

  /** Shows a file; what was done to it before can still be undone. */
  show(file: string, text: string): void {
    if (this.file !== "") {
      this.states.set(this.file, this.view.state);
    }
    const known = this.states.get(file);
    this.file = file;
    this.view.setState(known?.doc.toString() === text ? known : this.begun(file, text));
    this.mark(this.findings);
  }

  private begun(file: string, text: string): EditorState {
    return EditorState.create({ doc: text, extensions: [this.extensions, isProgram(file) ? this.help : []] });
  }

  get shown(): string {
    return this.file;
  }

  get text(): string {
    return this.view.state.doc.toString();
  }

  /** Underlines what was found in the file that is shown. */
  mark(findings: readonly Finding[]): void {
    this.findings = findings;
    const { doc } = this.view.state;
    const marks = findings.flatMap((finding): Diagnostic[] => {
      const { place } = finding;
      if (place?.file !== this.file) {
        return [];
      }
      const [from, to] = [offset(doc, place.start), offset(doc, place.end)];
      const severity = finding.severity === "error" ? "error" : finding.severity === "warning" ? "warning" : "info";
      return [
        {
          from,
          to: Math.max(from, to),
          severity,
          message: finding.message,
          renderMessage: () =>
            h(
              "div",
              {},
              h("p", {}, ...inline(finding.message)),
              finding.help == null ? undefined : h("p", { class: "help" }, ...inline(finding.help)),
            ),
          actions: finding.fixes.map((fix) => ({ name: fix.title, apply: () => this.listener.fix(fix) })),
        },
      ];
    });
    this.view.dispatch(setDiagnostics(this.view.state, marks));
  }

  /** Puts the cursor to a place in the file that is shown. */
  goTo(place: Place): void {
    const at = offset(this.view.state.doc, place.start);
    this.view.dispatch({
      selection: EditorSelection.cursor(at),
      effects: EditorView.scrollIntoView(at, { y: "center" }),
    });
    this.view.focus();
  }

  /** Makes changes of the file that is shown, as one step that can be undone. */
  change(edits: readonly Edit[]): void {
    const { doc } = this.view.state;
    this.view.dispatch({
      changes: edits.map(({ place, text }) => ({ from: offset(doc, place.start), to: offset(doc, place.end), insert: text })),
      annotations: Transaction.userEvent.of("input.fix"),
    });
  }

  /** Replaces the whole text and keeps the cursor about where it is. */
  replace(text: string): void {
    const { doc, selection } = this.view.state;
    if (doc.toString() === text) {
      return;
    }
    const at = position(doc, selection.main.head);
    this.view.dispatch({ changes: { from: 0, to: doc.length, insert: text } });
    this.view.dispatch({ selection: EditorSelection.cursor(offset(this.view.state.doc, at)) });
  }

  focus(): void {
    this.view.focus();
  }
}
