/** The extension: what VS Code calls when a .csp file is opened, and when it is no longer needed. */

import * as vscode from "vscode";
import { DiagramView } from "./diagram";
import { openExample } from "./examples";
import { Server } from "./server";

export async function activate(context: vscode.ExtensionContext): Promise<void> {
  const output = vscode.window.createOutputChannel("cspdiag", { log: true });
  const server = new Server(context, output);
  const diagram = new DiagramView(context, server);
  context.subscriptions.push(
    output,
    server,
    diagram,
    vscode.commands.registerCommand("cspdiag.showDiagram", () => {
      diagram.open();
    }),
    vscode.commands.registerCommand("cspdiag.exportDiagram", () => diagram.export()),
    vscode.commands.registerCommand("cspdiag.restartServer", () => server.restart()),
    vscode.commands.registerCommand("cspdiag.install", () => server.install()),
    vscode.commands.registerCommand("cspdiag.showOutput", () => {
      output.show();
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
  return Promise.resolve();
}
