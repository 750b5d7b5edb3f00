/** The extension: what VS Code calls when a .csp file is opened, and when it is no longer needed. */

import * as vscode from "vscode";
import type { Step } from "./counterexample";
import { DiagramView } from "./diagram";
import { openExample } from "./examples";
import { Figures } from "./figures";
import { Runs } from "./run";
import { Server } from "./server";
import { reasonOf } from "./reason";
import { isTrusted } from "./trust";
import { Walkthrough } from "./walkthrough";

export async function activate(context: vscode.ExtensionContext): Promise<void> {
  const output = vscode.window.createOutputChannel("cspdiag", { log: true });
  const figures = new Figures(vscode.Uri.joinPath(context.globalStorageUri, "figures").fsPath);
  const runs = new Runs(output, figures);
  const server = new Server(context, output, runs);
  const diagram = new DiagramView(context, server);
  const walkthrough = new Walkthrough();
  const run = async (plot: boolean, uri: string, environment: string) => {
    const cspdiag = server.cspdiag;
    if (cspdiag === undefined) {
      void vscode.window.showErrorMessage(`${environment} was not run: cspdiag is not running.`);
    } else if (await isTrusted(plot ? "plotted" : "run")) {
      walkthrough.did("verify");
      await runs.run(cspdiag, vscode.Uri.parse(uri), environment, plot);
    }
  };
  context.subscriptions.push(
    output,
    server,
    diagram,
    runs,
    walkthrough,
    // What the server's lenses call; their arguments are those of cspdiag.lsp.features.lenses.
    vscode.commands.registerCommand("cspdiag.run", (...given: [string, string]) => run(false, ...given)),
    vscode.commands.registerCommand("cspdiag.plot", (...given: [string, string]) => run(true, ...given)),
    vscode.commands.registerCommand("cspdiag.step", async (uri: string, steps: Step[]) => {
      await diagram.walk(await vscode.workspace.openTextDocument(vscode.Uri.parse(uri)), steps);
    }),
    vscode.commands.registerCommand("cspdiag.nextStep", () => diagram.move(1)),
    vscode.commands.registerCommand("cspdiag.previousStep", () => diagram.move(-1)),
    vscode.commands.registerCommand("cspdiag.showDiagram", () => {
      diagram.open();
      walkthrough.did("diagram");
    }),
    vscode.commands.registerCommand("cspdiag.exportDiagram", () => diagram.export()),
    vscode.commands.registerCommand("cspdiag.restartServer", () => server.restart()),
    vscode.commands.registerCommand("cspdiag.install", () => server.install()),
    vscode.commands.registerCommand("cspdiag.showOutput", () => {
      output.show();
    }),
    vscode.commands.registerCommand("cspdiag.showTrouble", () => {
      server.trouble.show();
    }),
    vscode.commands.registerCommand("cspdiag.openExample", async () => {
      await server.start();
      if (server.command !== undefined) {
        try {
          if (await openExample(server.command)) {
            walkthrough.did("example");
          }
        } catch (problem) {
          void vscode.window.showErrorMessage(`The example was not copied: ${reasonOf(problem)}`);
        }
      }
    }),
    server.onDidChange((client) => {
      if (client !== undefined) {
        walkthrough.did("install");
      }
    }),
    vscode.workspace.onDidGrantWorkspaceTrust(() => server.start()),
    vscode.workspace.onDidChangeConfiguration(async (change) => {
      if (change.affectsConfiguration("cspdiag.path")) {
        await server.restart();
      }
    }),
  );
  // Not awaited: VS Code shows the file while the server starts.
  void server.start();
  void figures.removeOld();
  return Promise.resolve();
}
