/** Copies an example out of cspdiag into the open folder, and opens it. */

import * as path from "node:path";
import * as vscode from "vscode";
import { run } from "./probe";

/** The names and summaries in the output of `cspdiag examples`. */
export function listed(output: string): { label: string; description: string }[] {
  const lines = output.split("\n").filter((line) => line.trim() !== "");
  return lines.map((line) => {
    const [label = "", ...summary] = line.split(/\s{2,}/);
    return { label, description: summary.join(" ") };
  });
}

/** Lets the user choose an example and a folder for it. */
export async function openExample(cspdiag: string): Promise<void> {
  const list = await run(cspdiag, ["examples"]);
  if (list.status !== 0) {
    throw new Error(list.errors.trim());
  }
  const chosen = await vscode.window.showQuickPick(listed(list.output), { placeHolder: "The example to copy" });
  const folder = chosen === undefined ? undefined : await destination();
  if (chosen === undefined || folder === undefined) {
    return;
  }
  const copied = await run(cspdiag, ["examples", chosen.label, "-o", folder]);
  if (copied.status !== 0) {
    throw new Error(copied.errors.trim());
  }
  const main = path.join(folder, chosen.label, `${chosen.label}.csp`);
  await vscode.window.showTextDocument(vscode.Uri.file(main));
}

/** The open folder, or one that the user chooses. */
async function destination(): Promise<string | undefined> {
  const open = vscode.workspace.workspaceFolders?.[0];
  if (open !== undefined) {
    return open.uri.fsPath;
  }
  const options = { canSelectFolders: true, canSelectFiles: false, openLabel: "Copy Here" };
  return (await vscode.window.showOpenDialog(options))?.[0]?.fsPath;
}
