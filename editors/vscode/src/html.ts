/** The page of the diagram before there is one in it; what is done with it is in `webview/page.ts`. */

import { randomBytes } from "node:crypto";
import * as vscode from "vscode";

export function page(webview: vscode.Webview, extension: vscode.Uri): string {
  const file = (name: string) => webview.asWebviewUri(vscode.Uri.joinPath(extension, "dist", name)).toString();
  const nonce = randomBytes(16).toString("base64");
  const policy = `default-src 'none'; style-src ${webview.cspSource}; script-src 'nonce-${nonce}'`;
  return `<!DOCTYPE html>
<html lang="en">
<head>
  <meta charset="utf-8">
  <meta http-equiv="Content-Security-Policy" content="${policy}">
  <link rel="stylesheet" href="${file("page.css")}">
  <title>Diagram</title>
</head>
<body>
  <header role="toolbar" aria-label="Diagram">
    <select id="process" aria-label="Process"></select>
    <select id="which" aria-label="Which diagram">
      <option value="both">Both diagrams</option>
      <option value="communication">Communication</option>
      <option value="composition">Composition</option>
    </select>
    <button id="smaller" title="Smaller (-)" aria-label="Smaller">−</button>
    <button id="larger" title="Larger (+)" aria-label="Larger">+</button>
    <button id="fit" title="Fit the width (0)">Fit</button>
    <button id="export" title="Write an SVG, PNG or PDF">Export…</button>
  </header>
  <p id="status" role="status" hidden></p>
  <section id="steps" role="toolbar" aria-label="Counterexample" hidden>
    <button id="previous" title="Previous step">◀</button>
    <button id="next" title="Next step">▶</button>
    <output id="position"></output>
    <span id="step" role="status"></span>
    <button id="leave" title="Leave the counterexample" aria-label="Leave the counterexample">✕</button>
  </section>
  <main id="picture" tabindex="0" aria-label="The diagram; Tab goes through its elements, Enter goes to the text"></main>
  <script nonce="${nonce}" src="${file("page.js")}"></script>
</body>
</html>`;
}
