/** Runs a program in one of its environments; the result is shown where the environment is written. */

import { spawn } from "node:child_process";
import { existsSync } from "node:fs";
import * as path from "node:path";
import * as vscode from "vscode";
import type { Figures } from "./figures";
import type { Result } from "./lenses";
import { brief, outcome, titleOf } from "./lenses";

/** How a run ended: its exit code (null if it was stopped), and what it printed. */
interface Ended {
  status: number | null;
  output: string;
}

export class Runs implements vscode.Disposable {
  /** For each document, what the last run of each environment said. */
  private readonly results = new Map<string, Map<string, Result>>();
  private readonly changed = new vscode.EventEmitter<void>();
  /** Lenses have other titles. */
  readonly onDidChange = this.changed.event;

  constructor(
    private readonly output: vscode.LogOutputChannel,
    private readonly figures: Figures,
  ) {}

  dispose(): void {
    this.changed.dispose();
  }

  /** The lenses of a document, with a further one for each result. */
  withResults(document: vscode.TextDocument, lenses: readonly vscode.CodeLens[]): vscode.CodeLens[] {
    const results = this.results.get(document.uri.toString());
    return lenses.flatMap((lens) => {
      if (lens.command !== undefined) {
        lens.command = { ...lens.command, ...brief(lens.command.title) };
      }
      const environment: unknown = lens.command?.arguments?.[1];
      const result = typeof environment === "string" ? results?.get(environment) : undefined;
      if (result === undefined || lens.command?.command !== "cspdiag.plot") {
        return [lens];
      }
      return [lens, new vscode.CodeLens(lens.range, { ...brief(titleOf(result, document.getText())), command: "cspdiag.showOutput" })];
    });
  }

  /** Runs the saved text of a file; with `plot` a figure is shown beside it. */
  async run(cspdiag: string, uri: vscode.Uri, environment: string, plot: boolean): Promise<void> {
    const document = await vscode.workspace.openTextDocument(uri);
    if (document.isDirty && !(await document.save())) {
      void vscode.window.showErrorMessage(`${uri.fsPath} was not run: it could not be saved.`);
      return;
    }
    const text = document.getText();
    const time = vscode.workspace.getConfiguration("cspdiag").get("run.for", "20 s").replaceAll(" ", "");
    const folder = path.dirname(uri.fsPath);
    const args = ["run", uri.fsPath, "--environment", environment, "--color", "never"];
    if (time !== "") {
      args.push("--for", time);
    }
    const figure = plot ? await this.figures.file(environment) : undefined;
    if (figure !== undefined) {
      args.push("--plot", figure);
    }
    const ended = await vscode.window.withProgress(
      { location: vscode.ProgressLocation.Notification, title: `Running ${environment}`, cancellable: true },
      (_, token) => execute(cspdiag, args, folder, token),
    );
    this.output.info(`cspdiag run ${uri.fsPath} --environment ${environment}\n${ended.output.trim()}`);
    const said = ended.status === null ? "stopped" : outcome(ended.output, environment, time, folder);
    this.keep(uri, environment, { text, outcome: said });
    if (figure === undefined) {
      return;
    }
    if (existsSync(figure)) {
      // Also of a run that failed: it shows how it came to that.
      const beside = { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true };
      await vscode.commands.executeCommand("vscode.open", vscode.Uri.file(figure), beside);
    } else if (ended.status !== null) {
      await this.without(environment, said);
    }
  }

  /** Says that a run has left no figure, and why. */
  private async without(environment: string, said: string): Promise<void> {
    const message = `${environment} has no figure: ${said}`;
    if ((await vscode.window.showErrorMessage(message, "Show Output")) === "Show Output") {
      this.output.show();
    }
  }

  private keep(uri: vscode.Uri, environment: string, result: Result): void {
    const key = uri.toString();
    const known = this.results.get(key) ?? new Map<string, Result>();
    known.set(environment, result);
    this.results.set(key, known);
    this.changed.fire();
  }
}

function execute(command: string, args: string[], cwd: string, token: vscode.CancellationToken): Promise<Ended> {
  return new Promise((resolve) => {
    const child = spawn(command, args, { cwd, stdio: ["ignore", "pipe", "pipe"] });
    let output = "";
    const collect = (data: Buffer) => (output += data.toString());
    child.stdout.on("data", collect);
    child.stderr.on("data", collect);
    token.onCancellationRequested(() => child.kill("SIGINT"));
    child.on("error", (problem) => {
      resolve({ status: 1, output: String(problem) });
    });
    child.on("close", (status) => {
      resolve({ status: token.isCancellationRequested ? null : status, output });
    });
  });
}
