/** What keeps the server from running: said in a notification and in the status bar, as long as it is so. */

import * as vscode from "vscode";

/** What the user can do about it. */
export interface Way {
  title: string;
  command: string;
  argument?: string;
}

/** Milliseconds until the notification goes; the status bar goes on saying it. */
const SHOWN = 30_000;

export class Trouble implements vscode.Disposable {
  private readonly item = vscode.window.createStatusBarItem("cspdiag.trouble", vscode.StatusBarAlignment.Left);
  private withdraw: (() => void) | undefined;
  private said: { message: string; ways: readonly Way[] } | undefined;

  constructor() {
    this.item.name = "cspdiag";
    this.item.text = "$(warning) cspdiag";
    this.item.command = "cspdiag.showTrouble";
    this.item.backgroundColor = new vscode.ThemeColor("statusBarItem.warningBackground");
  }

  /** What is wrong, if anything is. */
  get message(): string | undefined {
    return this.said?.message;
  }

  /** Says what is wrong; what was said before no longer is. */
  say(message: string, ways: readonly Way[]): void {
    this.mended();
    this.said = { message, ways };
    this.item.tooltip = message;
    this.item.show();
    this.show();
  }

  /** Shows the notification, again if it has gone. */
  show(): void {
    this.withdraw?.();
    if (this.said === undefined) {
      return;
    }
    const { message, ways } = this.said;
    const links = ways.map(({ title, command, argument }) => {
      const given = argument === undefined ? "" : `?${encodeURIComponent(JSON.stringify(argument))}`;
      return `[${title}](command:${command}${given})`;
    });
    // Only what is shown as progress can be withdrawn, and it has no buttons. Names of files are no links.
    const title = `${message.replaceAll("](", "] (")} ${links.join(" · ")}`;
    const over = new Promise<void>((resolve) => {
      const timer = setTimeout(resolve, SHOWN);
      this.withdraw = () => {
        clearTimeout(timer);
        resolve();
      };
    });
    // What can be cancelled is shown unfolded.
    const options = { location: vscode.ProgressLocation.Notification, title, cancellable: true };
    void vscode.window.withProgress(options, (progress, cancelled) => {
      progress.report({ increment: 100 });
      cancelled.onCancellationRequested(() => this.withdraw?.());
      return over;
    });
  }

  /** Nothing is wrong any more, as far as is known. */
  mended(): void {
    this.withdraw?.();
    this.withdraw = undefined;
    this.said = undefined;
    this.item.hide();
  }

  dispose(): void {
    this.mended();
    this.item.dispose();
  }
}
