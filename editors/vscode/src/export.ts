/** Writes a diagram into a file that the user chooses. */

import * as path from "node:path";
import * as vscode from "vscode";
import type { LanguageClient } from "vscode-languageclient/node";
import type { Which } from "./messages";
import { reasonOf } from "./reason";

/** Which diagrams of which program, as in a request for them. */
export interface Wanted {
  textDocument: { uri: string };
  which: Which;
}

const FORMATS = ["svg", "png", "pdf"];

/** Writes what the server answers to a request for a diagram; `name` is that of the diagram. */
export async function exportDiagram(client: LanguageClient, wanted: Wanted, name: string): Promise<void> {
  const file = await chosenFile(vscode.Uri.joinPath(vscode.Uri.parse(wanted.textDocument.uri), "..", `${name}.svg`));
  if (file === undefined) {
    return;
  }
  const written = path.posix.basename(file.target.path);
  try {
    const params = { ...wanted, process: name, format: file.format };
    const answer = await client.sendRequest<{ data?: string; problem?: string } | null>("cspdiag/diagram", params);
    if (answer?.data === undefined) {
      throw new Error(answer?.problem ?? "there was a later request for it");
    }
    await vscode.workspace.fs.writeFile(file.target, Buffer.from(answer.data, "base64"));
    void vscode.window.showInformationMessage(`The diagram of ${name} is in ${written}.`);
  } catch (problem) {
    void vscode.window.showErrorMessage(`The diagram was not exported as ${written}: ${reasonOf(problem)}.`);
  }
}

/** The format that the ending of a name means. */
function formatOf(name: string): string | undefined {
  return FORMATS.find((format) => name.toLowerCase().endsWith(`.${format}`));
}

/** Lets the user choose a file until its ending says the format; undefined if there is none. */
async function chosenFile(proposed: vscode.Uri): Promise<{ target: vscode.Uri; format: string } | undefined> {
  // Without filters: with them the dialog puts an ending of its own behind one that it does not know.
  const title = "Export the diagram as .svg, .png or .pdf";
  const target = await vscode.window.showSaveDialog({ defaultUri: proposed, title });
  if (target === undefined) {
    return undefined;
  }
  const name = path.posix.basename(target.path);
  const format = formatOf(name);
  if (format !== undefined) {
    return { target, format };
  }
  const answer = await vscode.window.showWarningMessage(
    `The diagram was not exported as ${name}: the ending of the name says the format, and has to be .svg, .png or .pdf.`,
    { modal: true },
    "Choose Another Name",
  );
  if (answer === undefined) {
    return undefined;
  }
  const stem = name.slice(0, name.length - path.posix.extname(name).length);
  return chosenFile(vscode.Uri.joinPath(target, "..", `${stem}.svg`));
}
