/** Snippets, which are offered where the server proposes the word that they begin with. */

import * as vscode from "vscode";
import SNIPPETS from "../snippets/csp.json";
import { beginning } from "./beginning";

/** What the server has found, and the snippets that fit there; VS Code itself would offer them after any letters. */
export function withSnippets(
  found: vscode.CompletionItem[] | vscode.CompletionList | null | undefined,
): vscode.CompletionItem[] | vscode.CompletionList | null | undefined {
  const items = Array.isArray(found) ? found : (found?.items ?? []);
  const words = new Set(items.filter((item) => item.kind === vscode.CompletionItemKind.Keyword).map(({ label }) => label));
  const snippets = ALL.filter(({ word }) => words.has(word)).map(({ item }) => item);
  if (Array.isArray(found)) {
    return [...found, ...snippets];
  }
  found?.items.push(...snippets);
  return found;
}

const ALL = Object.values(SNIPPETS).map(({ prefix, description, body }) => {
  const text = typeof body === "string" ? body : body.join("\n");
  const item = new vscode.CompletionItem({ label: prefix, description: "snippet" }, vscode.CompletionItemKind.Snippet);
  item.detail = description;
  item.insertText = new vscode.SnippetString(text);
  item.sortText = `~${prefix}`; // After what the server proposes.
  return { word: beginning(text), item };
});
