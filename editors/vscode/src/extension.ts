/** The extension: what VS Code calls when a .csp file is opened, and when it is no longer needed. */

import * as vscode from "vscode";
import { DiagramView } from "./diagram";
import type { Step } from "./diagram";
import { openExample } from "./examples";
import { Figures } from "./figures";
import { Runs } from "./run";
import { Server } from "./server";
import { isTrusted } from "./trust";

export async function activate(context: vscode.ExtensionContext): Promise<void> {
  const output = vscode.window.createOutputChannel("cspdiag", { log: true });
  const figures = new Figures(vscode.Uri.joinPath(context.globalStorageUri, "figures").fsPath);
  const runs = new Runs(output, figures);
  const server = new Server(context, output, runs);
  const diagram = new DiagramView(context, server);
  const run = async (plot: boolean, uri: string, environment: string) => {
    const cspdiag = server.cspdiag;
    if (cspdiag === undefined) {
      void vscode.window.showErrorMessage(`${environment} was not run: cspdiag is not running.`);
    } else if (await isTrusted(plot ? "plotted" : "run")) {
      await runs.run(cspdiag, vscode.Uri.parse(uri), environment, plot);
    }
  };
  context.subscriptions.push(
    output,
    server,
    diagram,
    runs,
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
        await openExample(server.command).catch((problem: unknown) => {
          void vscode.window.showErrorMessage(`The example was not copied: ${String(problem)}`);
        });
      }
    }),
    server.onDidChange((client) => {
      void vscode.commands.executeCommand("setContext", "cspdiag.running", client !== undefined);
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
