/** The files of the program on the machine where its engine runs: saves them, and takes over what others have written. */

import { type Engine, inWords } from "../engine/engine";
import type { Program } from "../engine/messages";
import { element } from "../page/dom";
import type { Workspace } from "./workspace";

const names = (files: readonly (readonly [string, string])[]) => files.map(([name]) => name);

export class Saving {
  private readonly button = element("save", HTMLButtonElement);
  /** The texts as they are on the disk, of the program that the engine was started with. */
  private saved: Record<string, string> = {};
  /** That program, with what was written into it while it was shown. */
  own: Program | undefined;
  /** The files that it had and that are not there any more. */
  private missing: readonly string[] = [];
  /** Whether that program is shown, and not an example or that of a link. */
  shown = false;

  constructor(
    private readonly engine: Engine,
    private readonly workspace: Workspace,
    private readonly report: (text: string) => void,
    private readonly write: (file: string, text: string) => void,
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
    workspace.onChange(() => {
      this.own = this.shown ? workspace.program : this.own;
      this.paint();
    });
  }

  /** The engine has opened this program from the disk. */
  offer(program: Program): void {
    this.saved = { ...program.files };
    this.own = program;
    this.paint();
  }

  /** Files have changed on the disk: they are shown as they are there, unless they have also changed here. */
  take({ files, main }: Program): void {
    if (this.own === undefined) {
      return;
    }
    if (main !== this.own.main) {
      this.report("The program on disk has files in other folders now: reload the page to have them.");
      return;
    }
    const here = this.own.files;
    const others = Object.entries(files).filter(([name, text]) => text !== this.saved[name]);
    const taken = others.filter(([name]) => here[name] === this.saved[name]);
    const kept = others.filter(([name, text]) => here[name] !== this.saved[name] && here[name] !== text);
    const keeps = new Set(kept.map(([name]) => name));
    for (const [name, text] of others.filter(([each]) => !keeps.has(each))) {
      this.saved[name] = text;
    }
    if (this.shown) {
      taken.forEach(([name, text]) => this.write(name, text));
    } else {
      this.own = { ...this.own, files: { ...here, ...Object.fromEntries(taken) } };
    }
    this.say(names(taken), this.shown ? "changed on disk, and now shown as on disk" : "changed on disk");
    const missing = Object.keys(this.saved).filter((name) => !(name in files));
    this.say(missing.filter((name) => !this.missing.includes(name)), "no longer a file of the program on the disk; here it is as it was");
    this.missing = missing;
    this.say(names(kept), "changed on disk as well as here: to have what is there, copy what you want to keep, and reload the page");
    this.paint();
  }

  private say(files: readonly string[], what: string): void {
    if (files.length > 0) {
      this.report(`${files.join(", ")}: ${what}.`);
    }
  }

  /** A program is shown: that of the disk, or another one. */
  opens(isOwn: boolean): void {
    this.shown = this.own !== undefined && isOwn;
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
    if (this.own === undefined) {
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
