/** What the server says to be under way, as notifications in which it can be cancelled. */

import * as vscode from "vscode";
import type { LanguageClient, Middleware } from "vscode-languageclient/node";

type Handler = NonNullable<Middleware["handleWorkDoneProgress"]>;

/** Shows what can be cancelled as a notification: by itself the client shows it in the status bar, without a button. */
export function cancellable(client: () => LanguageClient | undefined): Handler {
  const ends = new Map<string | number, () => void>();
  return (token, params, next) => {
    if (params.kind === "begin" && params.cancellable === true) {
      const options = { location: vscode.ProgressLocation.Notification, title: params.title, cancellable: true };
      const end = new Promise<void>((resolve) => ends.set(token, resolve));
      void vscode.window.withProgress(options, (progress, cancelled) => {
        progress.report(params.message === undefined ? {} : { message: params.message });
        cancelled.onCancellationRequested(() => {
          void client()?.sendNotification("window/workDoneProgress/cancel", { token });
        });
        return end;
      });
      return;
    }
    if (params.kind === "end") {
      ends.get(token)?.();
      ends.delete(token);
    }
    next(token, params);
  };
}
