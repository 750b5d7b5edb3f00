/** Installs cspdiag into a virtual environment, in a terminal in which the user sees what happens. */

import * as path from "node:path";
import * as vscode from "vscode";

/** What is installed: the server, and what the diagrams, plots and proofs of the extension need. */
export const REQUIREMENT = "cspdiag[lsp,draw,plot,verify]";

/** The commands that install cspdiag into an environment, which is created if it is not there. */
export function commands(environment: string, platform: NodeJS.Platform): string[][] {
  const windows = platform === "win32";
  const paths = windows ? path.win32 : path.posix;
  const python = windows ? paths.join(environment, "Scripts", "python.exe") : paths.join(environment, "bin", "python");
  return [
    [windows ? "py" : "python3", "-m", "venv", environment],
    [python, "-m", "pip", "install", "--upgrade", REQUIREMENT],
  ];
}

/** The commands as a person would type them. */
export function shown(command: readonly string[]): string {
  return command.map((word) => (/^[\w./:\\-]+$/.test(word) ? word : `"${word}"`)).join(" ");
}

/** Says what would be run and, if the user agrees, runs it. Returns whether cspdiag is installed then. */
export async function install(environment: string): Promise<boolean> {
  const wanted = commands(environment, process.platform);
  const detail = `This runs in a terminal:\n\n${wanted.map(shown).join("\n\n")}`;
  const answer = await vscode.window.showInformationMessage(
    `Install cspdiag into ${environment}?`,
    { modal: true, detail },
    "Install",
  );
  if (answer !== "Install") {
    return false;
  }
  for (const command of wanted) {
    if ((await runInTerminal(command)) !== 0) {
      void vscode.window.showErrorMessage(`cspdiag was not installed: ${command[2] ?? ""} failed, see the terminal`);
      return false;
    }
  }
  return true;
}

/** The exit code of a command that runs in a terminal; undefined if the terminal was closed. */
async function runInTerminal(command: readonly string[]): Promise<number | undefined> {
  const [program = "", ...args] = command;
  const execution = new vscode.ProcessExecution(program, args);
  const task = new vscode.Task({ type: "process" }, vscode.TaskScope.Workspace, "install cspdiag", "cspdiag", execution);
  task.presentationOptions = { reveal: vscode.TaskRevealKind.Always, panel: vscode.TaskPanelKind.Shared };
  return new Promise((resolve, reject) => {
    const listener = vscode.tasks.onDidEndTaskProcess((ended) => {
      if (ended.execution.task.name === task.name && ended.execution.task.source === task.source) {
        listener.dispose();
        resolve(ended.exitCode);
      }
    });
    vscode.tasks.executeTask(task).then(undefined, (problem: unknown) => {
      listener.dispose();
      reject(problem instanceof Error ? problem : new Error(String(problem)));
    });
  });
}
