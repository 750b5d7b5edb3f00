/** The diagram beside the text: drawn anew as the text changes, lit where the cursor is. */

import { basename } from "node:path";
import * as vscode from "vscode";
import type { Step } from "./counterexample";
import { Counterexample } from "./counterexample";
import type { Wanted } from "./export";
import { exportDiagram } from "./export";
import { page } from "./html";
import type { Chosen, FromPage, PagePart, ToPage, Which } from "./messages";
import type { Diagram, Part } from "./places";
import { definitionAt, partsAt, tellsMore } from "./places";
import { reasonOf } from "./reason";
import type { Server } from "./server";
import { BEING_DRAWN, Status } from "./status";

export const VIEW = "cspdiag.diagram";
/** The title of the tab while there is no diagram in it. */
const TITLE = "Diagram";
const BLANK = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 1 1"/>';
const NONE = "There is no diagram to export: open one first.";
/** Milliseconds without a change until a picture is drawn. */
const QUIET = 150;

export class DiagramView implements vscode.Disposable {
  private panel: vscode.WebviewPanel | undefined;
  private document: vscode.TextDocument | undefined;
  private picture: Diagram | undefined;
  /** The process that was chosen; without one the diagram is that at the cursor. */
  private process: string | undefined;
  private which: Which = "both";
  private timer: NodeJS.Timeout | undefined;
  /** How many pictures were asked for. */
  private asked = 0;
  private readonly status = new Status((text, stale) => {
    this.post({ type: "status", text, stale });
  });
  private counterexample = new Counterexample();
  /** The elements at the cursor, by identifier. */
  private lit: readonly string[] = [];
  private readonly disposables: vscode.Disposable[];

  constructor(
    private readonly context: vscode.ExtensionContext,
    private readonly server: Server,
  ) {
    const files = vscode.workspace.createFileSystemWatcher("**/*.{csp,fmu}");
    const imported = () => {
      this.drawSoon();
    };
    this.disposables = [
      files,
      // One that is not open may be imported.
      files.onDidChange(imported),
      files.onDidCreate(imported),
      files.onDidDelete(imported),
      vscode.workspace.onDidChangeTextDocument(({ document }) => {
        if (this.panel !== undefined && document.languageId === "csp") {
          this.leaveSteps();
          this.drawSoon();
        }
      }),
      vscode.window.onDidChangeActiveTextEditor((editor) => {
        if (editor !== undefined && isProgram(editor.document)) {
          this.show(editor.document);
        }
      }),
      // A text is opened once more when it becomes one in CSP.
      vscode.workspace.onDidOpenTextDocument((document) => {
        if (document === vscode.window.activeTextEditor?.document && isProgram(document)) {
          this.show(document);
          this.drawSoon();
        }
      }),
      vscode.window.onDidChangeTextEditorSelection(({ textEditor, kind }) => {
        if (textEditor.document === this.document) {
          this.follow(textEditor, kind !== undefined);
        }
      }),
      server.onDidChange((client) => {
        if (client === undefined) {
          this.sayNotRunning();
        } else {
          this.say(this.picture === undefined ? BEING_DRAWN : "");
          this.drawSoon();
        }
      }),
      vscode.window.registerWebviewPanelSerializer(VIEW, {
        deserializeWebviewPanel: async (panel, before: Chosen | undefined) => {
          await this.restore(before);
          this.use(panel);
        },
      }),
    ];
  }

  dispose(): void {
    clearTimeout(this.timer);
    this.status.stop();
    this.panel?.dispose();
    for (const each of this.disposables) {
      each.dispose();
    }
  }

  /** Shows the diagram of the active editor beside it. */
  open(): void {
    const editor = vscode.window.activeTextEditor;
    if (this.panel === undefined) {
      const column = { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true };
      // Its size and place stay while a figure is in front of it.
      const options = { enableScripts: true, retainContextWhenHidden: true };
      this.use(vscode.window.createWebviewPanel(VIEW, TITLE, column, options));
    } else {
      this.panel.reveal(undefined, true);
    }
    if (editor !== undefined && isProgram(editor.document)) {
      this.show(editor.document);
    }
  }

  /** Writes the diagram into a file that the user chooses. */
  async export(): Promise<void> {
    const client = this.server.running;
    const [document, picture] = [this.document, this.picture];
    if (client === undefined || document === undefined || picture === undefined) {
      void vscode.window.showInformationMessage(this.panel === undefined || document === undefined ? NONE : this.status.whyNone);
    } else {
      await exportDiagram(client, this.wanted(document), picture.name);
    }
  }

  /** Steps through a counterexample of the document. */
  async walk(document: vscode.TextDocument, steps: Step[]): Promise<void> {
    this.open();
    this.document = document;
    this.counterexample = new Counterexample(steps);
    await this.move(0);
  }

  /** Goes forwards or backwards in the counterexample. */
  async move(by: number): Promise<void> {
    this.counterexample.move(by);
    const step = this.counterexample.step;
    if (step !== undefined && this.picture?.name !== step.process) {
      this.process = step.process;
      await this.draw();
    }
    this.showStep();
  }

  private showStep(): void {
    this.post(this.counterexample.shownIn(this.picture));
    void vscode.commands.executeCommand("setContext", "cspdiag.stepping", this.counterexample.step !== undefined);
  }

  private leaveSteps(): void {
    if (this.counterexample.step !== undefined) {
      this.counterexample = new Counterexample();
      this.process = undefined;
      this.showStep();
      this.drawSoon();
    }
  }

  /** Takes what the diagram was of before the window was loaded again. */
  private async restore(before: Chosen | undefined): Promise<void> {
    this.which = before?.which ?? this.which;
    if (before?.uri !== undefined) {
      try {
        this.document = await vscode.workspace.openTextDocument(vscode.Uri.parse(before.uri));
        this.process = before.process;
      } catch {
        // The file is no longer there: the diagram is of what is open.
      }
    }
  }

  private use(panel: vscode.WebviewPanel): void {
    this.panel = panel;
    this.document ??= vscode.window.visibleTextEditors.find((editor) => isProgram(editor.document))?.document;
    panel.iconPath = vscode.Uri.joinPath(this.context.extensionUri, "images", "diagram.svg");
    const roots = ["dist"].map((name) => vscode.Uri.joinPath(this.context.extensionUri, name));
    panel.webview.options = { enableScripts: true, localResourceRoots: roots };
    panel.webview.onDidReceiveMessage((message: FromPage) => this.received(message));
    panel.onDidDispose(() => {
      this.panel = undefined;
      this.status.stop();
      this.leaveSteps();
    });
    panel.webview.html = page(panel.webview, this.context.extensionUri);
  }

  private show(document: vscode.TextDocument): void {
    if (document !== this.document) {
      this.document = document;
      this.picture = undefined; // The page keeps it until there is an answer.
      this.status.forget();
      this.process = undefined;
      this.counterexample = new Counterexample();
      this.showStep();
      this.drawSoon();
    }
  }

  private drawSoon(): void {
    clearTimeout(this.timer);
    if (this.panel !== undefined) {
      this.timer = setTimeout(() => void this.draw(), QUIET);
    }
  }

  private wanted(document: vscode.TextDocument): Wanted {
    return { textDocument: { uri: document.uri.toString() }, which: this.which };
  }

  private async draw(): Promise<void> {
    const [client, document] = [this.server.running, this.document];
    if (this.panel === undefined || document === undefined) {
      return;
    }
    if (client === undefined) {
      this.sayNotRunning();
      return;
    }
    const at = this.editor()?.selection.active;
    const chosen = this.process === undefined ? { position: at } : { process: this.process };
    const number = ++this.asked;
    this.waitForPicture();
    let answer: Diagram | null;
    try {
      answer = await client.sendRequest<Diagram | null>("cspdiag/diagram", { ...this.wanted(document), ...chosen });
    } catch (problem) {
      if (this.server.running === client) {
        this.say(`There is no diagram: ${reasonOf(problem)}`);
      }
      return; // Otherwise the server has ended, and what comes after it says so.
    }
    if (answer === null || document !== this.document) {
      return; // A later request is under way.
    }
    if (answer.problem !== undefined && this.picture === undefined && this.process !== undefined) {
      // The chosen process is no longer there.
      this.process = undefined;
      this.drawSoon();
    } else if (answer.problem !== undefined) {
      this.say(`There is no diagram: ${answer.problem}.`);
    } else if (tellsMore(this.picture, answer, this.process ?? this.atCursor())) {
      this.say("The text has mistakes in its syntax: this is the diagram before them.");
    } else {
      this.take(answer);
    }
    if (number !== this.asked) {
      this.waitForPicture();
    }
  }

  private waitForPicture(): void {
    const here = this.process ?? this.atCursor();
    const isElsewhere = this.picture === undefined || (here !== undefined && here !== this.picture.name);
    this.status.wait(isElsewhere ? "elsewhere" : "changed");
  }

  /** The process in which the cursor is, as far as the last picture knows it. */
  private atCursor(): string | undefined {
    const at = this.editor()?.selection.active;
    return at === undefined ? undefined : definitionAt(this.picture?.definitions ?? [], at);
  }

  private take(answer: Diagram): void {
    this.picture = answer;
    const parts: Record<string, PagePart> = {};
    for (const part of answer.parts) {
      parts[part.id] = { opens: part.inside !== null };
    }
    const processes = answer.definitions.map((each) => each.name);
    this.post({ type: "picture", svg: answer.svg, chosen: this.chosen(), processes, parts });
    this.say(answer.whole ? "" : "The text has mistakes in its syntax: what has them is left out.", !answer.whole);
    this.entitle(`Diagram of ${answer.name}`);
    const editor = this.editor();
    if (editor !== undefined) {
      // The cursor may have gone elsewhere while this was drawn.
      this.follow(editor, false);
    }
    this.showStep();
  }

  private chosen(): Chosen {
    return { uri: this.document?.uri.toString(), process: this.process, which: this.which };
  }

  private sayNotRunning(): void {
    const until = this.server.isStarting
      ? "cspdiag is being started."
      : "cspdiag is not running: there is no diagram of the text as it is now.";
    this.say(this.server.trouble.message ?? until);
  }

  /** Says what is so of the diagram, now that it is known. */
  private say(text: string, stale = text !== ""): void {
    if (this.picture === undefined) {
      this.post({ type: "picture", svg: BLANK, chosen: this.chosen(), processes: [], parts: {} });
      this.entitle(TITLE);
    }
    this.status.say(text, stale && this.picture !== undefined);
  }

  private entitle(title: string): void {
    if (this.panel !== undefined) {
      this.panel.title = title;
    }
  }

  private post(message: ToPage): void {
    void this.panel?.webview.postMessage(message);
  }

  private editor(): vscode.TextEditor | undefined {
    const shown = vscode.window.visibleTextEditors.filter((editor) => editor.document === this.document);
    return shown.find((editor) => editor === vscode.window.activeTextEditor) ?? shown[0];
  }

  /** Lights what is at the cursor, or draws the definition that it has gone to. */
  private follow(editor: vscode.TextEditor, moved: boolean): void {
    const picture = this.picture;
    if (picture === undefined || this.panel === undefined) {
      return;
    }
    const name = this.atCursor();
    if (this.process === undefined && name !== undefined && name !== picture.name) {
      this.drawSoon();
    } else {
      this.light(editor, moved);
    }
  }

  /** Lights what is at the cursor; what was not lit before, such as an element that was just written, is shown. */
  private light(editor: vscode.TextEditor, moved: boolean): void {
    const { line, character } = editor.selection.active;
    // In its indentation a line means what it begins with.
    const begin = editor.document.lineAt(line).firstNonWhitespaceCharacterIndex;
    const at = { line, character: Math.max(character, begin) };
    const ids = partsAt(this.picture?.parts ?? [], editor.document.uri.toString(), at).map((part) => part.id);
    const isOther = ids.some((id) => !this.lit.includes(id));
    this.lit = ids;
    this.post({ type: "lit", ids, reveal: moved || isOther });
  }

  private async received(message: FromPage): Promise<void> {
    switch (message.type) {
      case "ready":
        if (this.picture !== undefined && this.document !== undefined) {
          this.take(this.picture);
        }
        this.drawSoon();
        break;
      case "source":
        await this.reveal(this.part(message.id));
        break;
      case "inside": {
        const inside = this.part(message.id)?.inside ?? null;
        if (inside !== null) {
          this.process = inside;
          await this.draw();
        }
        break;
      }
      case "process":
        this.process = message.name === "" ? undefined : message.name;
        await this.draw();
        break;
      case "which":
        this.which = message.which;
        await this.draw();
        break;
      case "export":
        await this.export();
        break;
      case "move":
        await this.move(message.by);
        break;
      case "leave":
        this.leaveSteps();
        break;
    }
  }

  private part(id: string): Part | undefined {
    return this.picture?.parts.find((part) => part.id === id);
  }

  private async reveal(part: Part | undefined): Promise<void> {
    const place = part?.places[0];
    if (place === undefined) {
      return;
    }
    const uri = vscode.Uri.parse(place.uri);
    const column = this.editor()?.viewColumn ?? vscode.ViewColumn.One;
    try {
      // Without selecting it: what is typed next would replace it.
      const start = new vscode.Position(place.range.start.line, place.range.start.character);
      await vscode.window.showTextDocument(uri, { selection: new vscode.Range(start, start), viewColumn: column });
    } catch (problem) {
      void vscode.window.showErrorMessage(`${basename(uri.fsPath)} cannot be shown: ${reasonOf(problem)}`);
    }
  }
}

function isProgram(document: vscode.TextDocument): boolean {
  return document.languageId === "csp";
}
