/** Copies an example out of cspdiag into the open folder, and opens it. */

import { existsSync } from "node:fs";
import * as path from "node:path";
import * as vscode from "vscode";
import { run } from "./probe";

const OPEN = "Open It";

/** The names and summaries in the output of `cspdiag examples`. */
export function listed(output: string): { label: string; description: string }[] {
  const lines = output.split("\n").filter((line) => line.trim() !== "");
  return lines.map((line) => {
    const [label = "", ...summary] = line.split(/\s{2,}/);
    return { label, description: summary.join(" ") };
  });
}

/** Lets the user choose an example and a folder for it; whether it was opened. */
export async function openExample(cspdiag: string): Promise<boolean> {
  const list = await run(cspdiag, ["examples"]);
  if (list.status !== 0) {
    throw new Error(list.errors);
  }
  const chosen = await vscode.window.showQuickPick(listed(list.output), { placeHolder: "The example to copy" });
  const folder = chosen === undefined ? undefined : await destination();
  if (chosen === undefined || folder === undefined) {
    return false;
  }
  const copy = path.join(folder, chosen.label);
  const main = path.join(copy, `${chosen.label}.csp`);
  if (existsSync(copy)) {
    const message = `Nothing was copied: there is a ${chosen.label} in ${path.basename(folder)} already.`;
    const offered = existsSync(main) ? [OPEN] : [];
    if ((await vscode.window.showWarningMessage(message, ...offered)) !== OPEN) {
      return false;
    }
  } else {
    const copied = await run(cspdiag, ["examples", chosen.label, "-o", folder]);
    if (copied.status !== 0) {
      throw new Error(copied.errors);
    }
  }
  await vscode.window.showTextDocument(vscode.Uri.file(main));
  return true;
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
