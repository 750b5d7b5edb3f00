/** The language server: found, started, restarted when it ends by itself. */

import { existsSync, statSync } from "node:fs";
import { homedir } from "node:os";
import * as path from "node:path";
import * as vscode from "vscode";
import type { StaticFeature } from "vscode-languageclient/node";
import { CloseAction, ErrorAction, LanguageClient, State, Trace } from "vscode-languageclient/node";
import type { Found, Surroundings } from "./find";
import { expanded, find } from "./find";
import { install, REQUIREMENT } from "./install";
import type { Problem } from "./probe";
import { problemOf, run } from "./probe";
import { Work } from "./progress";
import { INTERRUPTED, Proofs } from "./proofs";
import { reasonOf } from "./reason";
import { Restarts } from "./restarts";
import type { Cspdiag, Runs } from "./run";
import { textOf } from "./settings";
import { withSnippets } from "./snippets";
import type { Way } from "./trouble";
import { Trouble } from "./trouble";
import { isTrusted, MANAGE_TRUST } from "./trust";

/** Milliseconds that a cspdiag may take to start before that is shown. */
const PATIENCE = 2_000;

export class Server implements vscode.Disposable {
  private client: LanguageClient | undefined;
  private found: Found | undefined;
  private starting: Promise<void> | undefined;
  /** Gives up what is being started. */
  private giveUp = new AbortController();
  private readonly proofs = new Proofs();
  private readonly work = new Work(() => this.running);
  /** What keeps the server from running. */
  readonly trouble = new Trouble();
  private readonly changed = new vscode.EventEmitter<LanguageClient | undefined>();
  /** The server is running, or, with undefined, no longer. */
  readonly onDidChange = this.changed.event;

  constructor(
    private readonly context: vscode.ExtensionContext,
    private readonly output: vscode.LogOutputChannel,
    private readonly runs: Runs,
  ) {
    runs.onDidChange(() => {
      // Lenses are asked for again, as after a request of the server.
      const provider = this.running?.getFeature("textDocument/codeLens");
      for (const document of provider === undefined ? [] : vscode.workspace.textDocuments) {
        provider?.getProvider(document)?.onDidChangeCodeLensEmitter.fire();
      }
    });
  }

  /** The connection to the server while it is running. */
  get running(): LanguageClient | undefined {
    return this.client?.state === State.Running ? this.client : undefined;
  }

  /** Whether it will soon run, or it will be known why not. */
  get isStarting(): boolean {
    return this.starting !== undefined || this.client?.state === State.Starting;
  }

  /** The cspdiag whose server is running. */
  get command(): string | undefined {
    return this.found?.command;
  }

  /** The cspdiag whose server is running, and which programs it knows. */
  get cspdiag(): Cspdiag | undefined {
    const [client, command] = [this.running, this.command];
    if (client === undefined || command === undefined) {
      return undefined;
    }
    return { command, program: (uri) => client.sendRequest("cspdiag/program", { textDocument: { uri: uri.toString() } }) };
  }

  /** Starts the server; says what keeps it from starting, and what can be done about that. */
  async start(): Promise<void> {
    this.starting ??= this.started().finally(() => (this.starting = undefined));
    await this.starting;
  }

  async restart(): Promise<void> {
    this.giveUp.abort();
    await this.starting;
    await this.stop();
    await this.start();
  }

  async stop(): Promise<void> {
    const client = this.client;
    this.client = undefined;
    this.found = undefined;
    this.ended();
    this.changed.fire(undefined);
    if (client?.needsStop() === true) {
      await client.stop().catch((problem: unknown) => {
        this.output.warn(`the server did not end as asked: ${reasonOf(problem)}`);
      });
    }
  }

  dispose(): void {
    void this.stop();
    this.trouble.dispose();
    this.changed.dispose();
  }

  /** Asks whether to install cspdiag, does it, and starts the server. */
  async install(): Promise<void> {
    if (await install(this.environment())) {
      await this.restart();
    }
  }

  /** What the server was doing has ended with it. */
  private ended(): void {
    this.proofs.serverEnded();
    this.work.serverEnded();
  }

  private async started(): Promise<void> {
    if (this.client !== undefined) {
      return;
    }
    this.giveUp = new AbortController();
    const { signal } = this.giveUp;
    this.trouble.mended();
    const around = await this.surroundings();
    this.changed.fire(undefined);
    const found = find(around);
    if (found === undefined) {
      this.missing(around);
      return;
    }
    this.output.info(`${found.command}, found in ${found.from}`);
    const problem = await this.asked(found.command, signal);
    if (signal.aborted) {
      return;
    }
    if (problem !== undefined) {
      this.output.error(problem.message);
      this.tell(advice(problem, found), [INSTALL, CHOOSE, AGAIN]);
      return;
    }
    await this.connect(found);
  }

  /** Asks a cspdiag whether it can serve; one that takes its time over the answer is named meanwhile. */
  private async asked(command: string, givenUp: AbortSignal): Promise<Problem | undefined> {
    const asking = problemOf(command, (program, args) => run(program, args, givenUp));
    const title = `${command} is being asked for its version…`;
    const options = { location: vscode.ProgressLocation.Notification, title };
    const timer = setTimeout(() => void vscode.window.withProgress(options, () => asking), PATIENCE);
    try {
      return await asking;
    } finally {
      clearTimeout(timer);
    }
  }

  private async connect(found: Found): Promise<void> {
    const restarts = new Restarts();
    const client = new LanguageClient(
      "cspdiag",
      "cspdiag",
      { command: found.command, args: ["lsp"] },
      {
        documentSelector: [
          { language: "csp", scheme: "file" },
          { language: "csp", scheme: "untitled" },
        ],
        outputChannel: this.output,
        middleware: {
          provideCodeLenses: async (document, token, next) =>
            this.runs.withResults(document, this.withInterrupted(document, (await next(document, token)) ?? [])),
          provideCompletionItem: async (document, position, context, token, next) =>
            withSnippets(await next(document, position, context, token)),
          handleWorkDoneProgress: this.work.show,
          executeCommand: async (command, given, next) => {
            const ask = async () => (await next(command, given)) as unknown;
            if (command !== VERIFY) {
              return ask();
            }
            // A proof may run parts of the program.
            return (await isTrusted("proved")) ? this.proofs.during(assertionAt(given as [string, number]), ask) : undefined;
          },
        },
        synchronize: { fileEvents: vscode.workspace.createFileSystemWatcher("**/*.{csp,py,c,h,fmu}") },
        errorHandler: {
          error: () => ({ action: ErrorAction.Continue, handled: true }),
          closed: () => {
            this.ended();
            const { again, say } = restarts.ended();
            this.output.error(`the server has ended by itself${again ? ", and is started again" : ""}`);
            if (say) {
              void this.sayRestarted();
            } else if (!again) {
              this.tell("The cspdiag server keeps ending by itself, and is not started again.", [AGAIN, OUTPUT]);
            }
            return { action: again ? CloseAction.Restart : CloseAction.DoNotRestart, handled: true };
          },
        },
      },
    );
    client.registerFeature(LENSES);
    this.client = client;
    this.found = found;
    client.onDidChangeState(({ newState }) => {
      if (this.client === client) {
        this.changed.fire(newState === State.Running ? client : undefined);
      }
    });
    try {
      await client.start();
      await client.setTrace(Trace.fromString(setting("trace.server")));
    } catch (problem) {
      this.client = undefined;
      this.tell(`The cspdiag server did not start: ${reasonOf(problem)}`, [AGAIN, OUTPUT]);
    }
  }

  /** The lenses of a document; those of interrupted proofs say so. */
  private withInterrupted(document: vscode.TextDocument, lenses: vscode.CodeLens[]): vscode.CodeLens[] {
    for (const lens of lenses) {
      const { command } = lens;
      if (command?.command === VERIFY && this.proofs.wasInterrupted(assertionOn(document, lens.range.start.line))) {
        lens.command = { ...command, title: INTERRUPTED };
      }
    }
    return lenses;
  }

  /** Says what keeps the server from running. */
  private tell(message: string, ways: readonly Way[]): void {
    this.trouble.say(message, ways);
    this.changed.fire(undefined);
  }

  private async sayRestarted(): Promise<void> {
    const message = "The cspdiag server ended by itself, and was started again.";
    if ((await vscode.window.showWarningMessage(message, "Show Output")) === "Show Output") {
      this.output.show();
    }
  }

  /** Says that there is no cspdiag, with the ways out. */
  private missing(around: Surroundings): void {
    if (around.setting.trim() !== "") {
      const file = expanded(around.setting, around);
      const message = existsSync(file)
        ? `${file}, which the setting cspdiag.path names, is a folder: name the program in it.`
        : `There is no file ${file}, which the setting cspdiag.path names.`;
      this.tell(message, [INSTALL, CHOOSE, AGAIN]);
    } else if (around.trusted) {
      this.tell("cspdiag is not installed here: errors, diagrams and proofs need it.", [INSTALL, CHOOSE, AGAIN]);
    } else {
      const message =
        "This folder is not trusted, so no cspdiag in it is started: that would run a program of the folder. There is no other cspdiag.";
      this.tell(message, [MANAGE_TRUST, CHOOSE]);
    }
  }

  /** The virtual environment to install into: that of the folder, or one of the extension's own. */
  private environment(): string {
    const folder = vscode.workspace.workspaceFolders?.[0];
    return folder === undefined ? this.storage() : path.join(folder.uri.fsPath, ".venv");
  }

  private storage(): string {
    return path.join(this.context.globalStorageUri.fsPath, "venv");
  }

  private async surroundings(): Promise<Surroundings> {
    return {
      setting: setting("path"),
      folders: (vscode.workspace.workspaceFolders ?? []).map((folder) => folder.uri.fsPath),
      trusted: vscode.workspace.isTrusted,
      interpreter: await interpreter(),
      storage: this.storage(),
      home: homedir(),
      searchPath: process.env["PATH"] ?? "",
      platform: process.platform,
      exists: isFile,
    };
  }
}

function isFile(file: string): boolean {
  try {
    return statSync(file).isFile();
  } catch {
    return false;
  }
}

/** The server's command for proofs: its arguments are the URI of a file and the line of an assertion, from 0. */
const VERIFY = "cspdiag.verify";

function assertionAt([uri, line]: [string, number]): string {
  const document = vscode.workspace.textDocuments.find((each) => each.uri.toString() === vscode.Uri.parse(uri).toString());
  return document === undefined ? "" : assertionOn(document, line);
}

/** What an assertion is known by: lines may be added before it. A lens may be of a longer text than that of now. */
function assertionOn(document: vscode.TextDocument, line: number): string {
  return `${document.uri.toString()} ${line < document.lineCount ? document.lineAt(line).text.trim() : ""}`;
}

const INSTALL: Way = { title: "Install…", command: "cspdiag.install" };
const CHOOSE: Way = { title: "Choose…", command: "workbench.action.openSettings", argument: "cspdiag.path" };
const AGAIN: Way = { title: "Try Again", command: "cspdiag.restartServer" };
const OUTPUT: Way = { title: "Show Output", command: "cspdiag.showOutput" };

/** Tells the server which commands its lenses may call here. */
const LENSES: StaticFeature = {
  fillClientCapabilities: (capabilities) => {
    const commands = ["cspdiag.run", "cspdiag.plot", "cspdiag.step"];
    capabilities.experimental = { ...(capabilities.experimental as object | undefined), cspdiag: { commands } };
  },
  initialize: () => undefined,
  getState: () => ({ kind: "static" }),
  clear: () => undefined,
};

function advice(problem: Problem, found: Found): string {
  const python = path.join(path.dirname(found.command), "python");
  const command = `"${python}" -m pip install --upgrade "${REQUIREMENT}"`;
  return problem.update ? `${problem.message}. Run ${command}, or install another one.` : `${problem.message}.`;
}

function setting(name: string): string {
  return textOf(vscode.workspace.getConfiguration("cspdiag").get(name));
}

/** What is used of the Python extension. */
interface PythonExtension {
  environments?: {
    getActiveEnvironmentPath: () => unknown;
    resolveEnvironment: (environment: unknown) => Promise<{ executable?: { uri?: vscode.Uri } } | undefined>;
  };
}

/** The interpreter that was chosen in the Python extension, if that is installed. */
async function interpreter(): Promise<string | undefined> {
  const extension = vscode.extensions.getExtension<PythonExtension>("ms-python.python");
  if (extension === undefined) {
    return undefined;
  }
  try {
    const environments = (await extension.activate()).environments;
    const found = await environments?.resolveEnvironment(environments.getActiveEnvironmentPath());
    return found?.executable?.uri?.fsPath;
  } catch {
    return undefined; // An extension that does not start is no reason to have no server.
  }
}
