/** Ticks the steps of the walkthrough that are done, also those that were done before it was opened. */

import * as vscode from "vscode";

/** The steps, by their names in package.json. */
export type Done = "install" | "example" | "diagram" | "verify";

/** Milliseconds from the opening of a tab until the walkthrough in it knows its steps. */
const READY = 1_000;

export class Walkthrough implements vscode.Disposable {
  private readonly done = new Set<Done>();
  private timer: NodeJS.Timeout | undefined;
  private readonly listener = vscode.window.tabGroups.onDidChangeTabs(({ opened, changed }) => {
    // The walkthrough is one of the tabs of whose content extensions know nothing.
    if ([...opened, ...changed].some((tab) => tab.isActive && tab.input === undefined)) {
      clearTimeout(this.timer);
      this.timer = setTimeout(() => {
        this.done.forEach(tick);
      }, READY);
    }
  });

  /** A step is done. */
  did(step: Done): void {
    this.done.add(step);
    tick(step);
  }

  dispose(): void {
    clearTimeout(this.timer);
    this.listener.dispose();
  }
}

/** Lets VS Code see a condition become true: of one that has been true before, its walkthrough takes no notice. */
function tick(step: Done): void {
  for (const holds of [true, false]) {
    void vscode.commands.executeCommand("setContext", `cspdiag.did.${step}`, holds);
  }
}
