/** Saves files of the program on the machine where its engine runs. */

import { type Engine, inWords } from "../engine/engine";
import type { Program } from "../engine/messages";
import { element } from "../page/dom";
import type { Workspace } from "./workspace";

export class Saving {
  private readonly button = element("save", HTMLButtonElement);
  /** The texts as they are on the disk, of the program that the engine was started with. */
  private saved: Record<string, string> = {};
  private offered = false;
  /** Whether that program is shown, and not an example or that of a link. */
  shown = false;

  constructor(
    private readonly engine: Engine,
    private readonly workspace: Workspace,
    private readonly report: (text: string) => void,
  ) {
    this.button.addEventListener("click", () => void this.save());
    window.addEventListener("keydown", (event) => {
      if ((event.ctrlKey || event.metaKey) && event.key === "s") {
        event.preventDefault();
        void this.save();
      }
    });
    window.addEventListener("beforeunload", (event) => {
      if (this.shown && this.changed().length > 0) {
        event.preventDefault();
      }
    });
    workspace.onChange(() => this.paint());
  }

  /** The engine has opened this program from the disk. */
  offer(program: Program): void {
    this.saved = { ...program.files };
    this.offered = true;
    this.paint();
  }

  /** A program is shown: that of the disk, or another one. */
  opens(isOwn: boolean): void {
    this.shown = this.offered && isOwn;
    this.paint();
  }

  private changed(): string[] {
    const { files } = this.workspace.program;
    return Object.keys(files).filter((name) => name in this.saved && files[name] !== this.saved[name]);
  }

  private paint(): void {
    this.button.hidden = !this.shown;
    this.button.disabled = this.changed().length === 0;
  }

  private async save(): Promise<void> {
    if (!this.offered) {
      this.report("Here nothing is saved: copy the link, which holds the whole program.");
      return;
    }
    if (!this.shown) {
      this.report("This is not the file on the disk, so it is not saved there: copy the link, which holds the whole program.");
      return;
    }
    if (this.changed().length === 0) {
      this.report("Nothing has changed since it was saved.");
    }
    for (const file of this.changed()) {
      const text = this.workspace.program.files[file] ?? "";
      try {
        await this.engine.request("save", { file, text, before: this.saved[file] ?? "" });
        this.saved[file] = text;
        this.report(`${file} is saved.`);
      } catch (problem) {
        this.report(inWords(problem));
      }
    }
    this.paint();
  }
}
