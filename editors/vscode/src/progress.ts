/** What the server says to be under way, as notifications in which it can be cancelled. */

import * as vscode from "vscode";
import type { LanguageClient, Middleware } from "vscode-languageclient/node";

type Handler = NonNullable<Middleware["handleWorkDoneProgress"]>;

export class Work {
  private readonly ends = new Map<string | number, () => void>();

  constructor(private readonly client: () => LanguageClient | undefined) {}

  /** Shows what can be cancelled as a notification: by itself the client shows it in the status bar, without a button. */
  readonly show: Handler = (token, params, next) => {
    if (params.kind === "begin" && params.cancellable === true) {
      const options = { location: vscode.ProgressLocation.Notification, title: params.title, cancellable: true };
      const end = new Promise<void>((resolve) => this.ends.set(token, resolve));
      void vscode.window.withProgress(options, (progress, cancelled) => {
        progress.report(params.message === undefined ? {} : { message: params.message });
        cancelled.onCancellationRequested(() => {
          void this.client()?.sendNotification("window/workDoneProgress/cancel", { token });
        });
        return end;
      });
      return;
    }
    if (params.kind === "end") {
      this.ends.get(token)?.();
      this.ends.delete(token);
    }
    next(token, params);
  };

  /** The server has ended: nothing is under way any more, and it cannot say so. */
  serverEnded(): void {
    for (const end of this.ends.values()) {
      end();
    }
    this.ends.clear();
  }
}
