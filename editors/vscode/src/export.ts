/** Which file a diagram is written to, and in which format. */

import * as path from "node:path";
import * as vscode from "vscode";

const FORMATS = ["svg", "png", "pdf"];

/** The format that the ending of a name means. */
function formatOf(name: string): string | undefined {
  return FORMATS.find((format) => name.toLowerCase().endsWith(`.${format}`));
}

/** Lets the user choose a file until its ending says the format; undefined if there is none. */
export async function chosenFile(proposed: vscode.Uri): Promise<{ target: vscode.Uri; format: string } | undefined> {
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
