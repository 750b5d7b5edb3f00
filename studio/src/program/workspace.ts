/** The program that is open: its files, and which of them is shown. */

import type { Program } from "../engine/messages";

export class Workspace {
  private listeners: (() => void)[] = [];
  program: Program = { files: {}, main: "" };
  shown = "";
  /** Grows with each change. */
  version = 0;
  /** Whether something was written since it was opened. */
  edited = false;
  /** Whether it came by a link. */
  linked = false;

  open(program: Program, linked = false): void {
    this.linked = linked;
    this.program = { files: { ...program.files }, main: program.main };
    this.shown = program.main;
    this.edited = false;
    this.changed();
  }

  write(file: string, text: string): void {
    if (this.program.files[file] !== text) {
      this.program = { ...this.program, files: { ...this.program.files, [file]: text } };
      this.edited = true;
      this.changed();
    }
  }

  /** The program without the pictures beside it, which the compiler does not read. */
  sources(): Program {
    const files = Object.entries(this.program.files).filter(([name]) => !name.endsWith(".svg"));
    return { files: Object.fromEntries(files), main: this.program.main };
  }

  onChange(listener: () => void): void {
    this.listeners.push(listener);
  }

  private changed(): void {
    this.version += 1;
    for (const listener of this.listeners) {
      listener();
    }
  }
}
