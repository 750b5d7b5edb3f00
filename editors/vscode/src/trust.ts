/** Whether the folder may have its programs run. */

import * as vscode from "vscode";
import type { Way } from "./trouble";

export const MANAGE_TRUST: Way = { title: "Manage Workspace Trust", command: "workbench.trust.manage" };

/** Whether the folder is trusted; if it is not, says that nothing of it is run, plotted or proved, and why. */
export async function isTrusted(done: string): Promise<boolean> {
  if (vscode.workspace.isTrusted) {
    return true;
  }
  const message = `Nothing is ${done}: this folder is not trusted, and what a program calls in it would be run.`;
  if ((await vscode.window.showWarningMessage(message, MANAGE_TRUST.title)) === MANAGE_TRUST.title) {
    await vscode.commands.executeCommand(MANAGE_TRUST.command);
  }
  return false;
}
