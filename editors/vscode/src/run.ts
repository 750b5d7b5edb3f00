/** Runs a program in one of its environments; the result is shown where the environment is written. */

import { spawn } from "node:child_process";
import { existsSync } from "node:fs";
import * as path from "node:path";
import * as vscode from "vscode";
import type { Figures } from "./figures";
import type { Printed, Result } from "./lenses";
import { brief, complaintDuring, lastComplaint, outcome, RUNNING, titleOf } from "./lenses";
import { Lines } from "./lines";
import { Newest } from "./newest";
import { reasonOf } from "./reason";
import { textOf } from "./settings";

/** The cspdiag that runs programs, and what its server knows of them. */
export interface Cspdiag {
  command: string;
  /** The files of an open program by URI, and its fingerprint; null if the server does not know it. */
  program: (uri: vscode.Uri) => Promise<Program | null>;
}

interface Program {
  files: string[];
  fingerprint: string;
}

/** How a run ended: whether it was stopped here, and the errors that it printed. */
interface Ended extends Printed {
  stopped: boolean;
}

export class Runs implements vscode.Disposable {
  /** For each document, what the last run of each environment said. */
  private readonly results = new Map<string, Map<string, Result>>();
  /** By document and environment. */
  private readonly underWay = new Newest();
  private readonly changed = new vscode.EventEmitter<void>();
  /** Lenses have other titles. */
  readonly onDidChange = this.changed.event;

  constructor(
    private readonly output: vscode.LogOutputChannel,
    private readonly figures: Figures,
  ) {}

  dispose(): void {
    this.underWay.endAll();
    this.changed.dispose();
  }

  /** The lenses of a document, with a further one for each result. */
  withResults(document: vscode.TextDocument, lenses: readonly vscode.CodeLens[]): vscode.CodeLens[] {
    const results = this.results.get(document.uri.toString());
    return lenses.flatMap((lens) => {
      if (lens.command !== undefined) {
        lens.command = { ...lens.command, ...brief(lens.command.title) };
      }
      const [, environment, , program] = (lens.command?.arguments ?? []) as unknown[];
      const result = typeof environment === "string" ? results?.get(environment) : undefined;
      if (result === undefined || lens.command?.command !== "cspdiag.plot") {
        return [lens];
      }
      return [lens, new vscode.CodeLens(lens.range, { ...brief(titleOf(result, program)), command: "cspdiag.showOutput" })];
    });
  }

  /** Saves the files of a program and runs it; with `plot` a figure is shown beside it. It takes the place of an earlier
   * run of the environment that has not ended. */
  async run(cspdiag: Cspdiag, given: vscode.Uri, environment: string, plot: boolean): Promise<void> {
    const uri = given.scheme === "untitled" ? await saveAs(given) : given;
    if (uri === undefined) {
      return;
    }
    const unsaved = await save((await cspdiag.program(uri))?.files ?? []);
    const program = await cspdiag.program(uri);
    if (unsaved !== undefined || program === null) {
      const reason = unsaved === undefined ? "it is not open, or too large" : `${path.basename(unsaved.fsPath)} could not be saved`;
      void vscode.window.showErrorMessage(`${environment} was not run: ${reason}.`);
      return;
    }
    const time = textOf(vscode.workspace.getConfiguration("cspdiag", uri).get("run.for")).replaceAll(" ", "");
    const folder = path.dirname(uri.fsPath);
    const args = ["run", uri.fsPath, "--environment", environment, "--color", "never"];
    if (time !== "") {
      args.push("--for", time);
    }
    const figure = plot ? await this.figures.file(environment) : undefined;
    if (figure !== undefined) {
      args.push("--plot", figure);
    }
    const key = `${uri.toString()} ${environment}`;
    const begun = this.underWay.begin(key);
    this.keep(uri, environment, { program: program.fingerprint, outcome: RUNNING });
    this.output.info(`cspdiag run ${uri.fsPath} --environment ${environment}`);
    const ended = await vscode.window.withProgress(
      { location: vscode.ProgressLocation.Notification, title: `Running ${environment}`, cancellable: true },
      (progress, token) => {
        token.onCancellationRequested(() => {
          begun.abort();
        });
        return execute(cspdiag.command, args, folder, begun.signal, (lines) => {
          this.show(lines);
          const message = complaintDuring(lines, folder);
          if (message !== undefined) {
            progress.report({ message });
          }
        });
      },
    );
    if (!this.underWay.end(key, begun)) {
      return;
    }
    const said = ended.stopped ? "stopped" : outcome(ended, environment, time, folder);
    this.keep(uri, environment, { program: program.fingerprint, outcome: said });
    if (figure === undefined) {
      return;
    }
    if (existsSync(figure)) {
      // Also of a run that failed: it shows how it came to that.
      const beside = { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true };
      await vscode.commands.executeCommand("vscode.open", vscode.Uri.file(figure), beside);
    } else if (!ended.stopped) {
      await this.without(environment, lastComplaint(ended.errors.split("\n")) ?? said);
    }
  }

  /** Writes lines of a run to the output, without blank ones around them. */
  private show(lines: readonly string[]): void {
    const text = lines.join("\n").replace(/^\n+/, "").trimEnd();
    if (text !== "") {
      this.output.info(text);
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

/** Saves a text that is in no file yet, and shows the file; undefined if its user has named none. */
async function saveAs(uri: vscode.Uri): Promise<vscode.Uri | undefined> {
  const saved = await vscode.workspace.save(uri);
  if (saved !== undefined) {
    await vscode.window.showTextDocument(saved);
  }
  return saved;
}

/** Saves those of some files that have changed in the editor; the first one that could not be saved, if any. */
async function save(files: readonly string[]): Promise<vscode.Uri | undefined> {
  const named = new Set(files.map((file) => vscode.Uri.parse(file).toString()));
  for (const document of vscode.workspace.textDocuments) {
    if (document.isDirty && named.has(document.uri.toString()) && !(await document.save())) {
      return document.uri;
    }
  }
  return undefined;
}

/** Runs a command; `said` is called with the lines that it prints, as soon as they are whole. */
function execute(command: string, args: string[], cwd: string, stop: AbortSignal, said: (lines: string[]) => void): Promise<Ended> {
  return new Promise((resolve) => {
    const child = spawn(command, args, { cwd, stdio: ["ignore", "pipe", "pipe"] });
    let errors = "";
    const [output, complaints] = [new Lines(), new Lines()];
    child.stdout.setEncoding("utf8").on("data", (text: string) => {
      said(output.take(text));
    });
    child.stderr.setEncoding("utf8").on("data", (text: string) => {
      errors += text;
      said(complaints.take(text));
    });
    stop.addEventListener("abort", () => child.kill("SIGINT"));
    child.on("error", (problem) => {
      const reason = `cspdiag could not be started: ${reasonOf(problem)}`;
      said([reason]);
      resolve({ stopped: false, errors: reason, signal: null });
    });
    child.on("close", (_, signal) => {
      said([...output.end(), ...complaints.end()]);
      resolve({ stopped: stop.aborted, errors, signal });
    });
  });
}
