/** Generated code to read and to download, the timing analysis, and margins. */

import { type Engine, inWords } from "../engine/engine";
import { button, element, h, options } from "../page/dom";
import type { Workspace } from "../program/workspace";
import { archive } from "./archive";

/** A line of a report: rows of its tables stay as they are, sentences are broken where there is no room. */
function reportLine(line: string): HTMLElement {
  return h("div", / {2,}\S/.test(line.trim()) ? {} : { class: "sentence" }, line === "" ? " " : line);
}

export class Generate {
  /** That of runs. */
  private readonly environment = element("environment", HTMLSelectElement);
  private readonly target = element("target", HTMLSelectElement);
  private readonly level = element("level", HTMLSelectElement);
  private readonly download = element("download", HTMLButtonElement);
  private readonly note = element("generate-note", HTMLElement);
  private readonly list = element("generated", HTMLElement);
  private readonly listing = element("listing", HTMLElement);
  private files: Record<string, string> = {};
  /** The target for which they were generated. */
  private made = "";
  /** Counts what was asked: only the last answer is shown. */
  private asked = 0;

  constructor(
    private readonly engine: Engine,
    private readonly workspace: Workspace,
  ) {
    element("generate", HTMLButtonElement).addEventListener("click", () => void this.generate());
    element("timing", HTMLButtonElement).addEventListener("click", () => void this.timing());
    element("margins", HTMLButtonElement).addEventListener("click", () => void this.margins());
    this.download.addEventListener("click", () => this.save());
  }

  offer(targets: readonly string[]): void {
    options(this.target, targets.map((name) => [name, name] as const));
  }

  /** The program has changed: what was generated is not its code any more. */
  reset(): void {
    this.show({});
    this.listing.textContent = "";
    this.say("");
  }

  private async generate(): Promise<void> {
    const target = this.target.value;
    const asked = { ...this.workspace.sources(), target, level: Number(this.level.value) };
    await this.answer(async () => {
      const { files } = await this.engine.request("compile", asked);
      return () => {
        this.made = target;
        this.show(files);
      };
    });
  }

  private timing(): Promise<void> {
    return this.report(() => this.engine.request("timing", this.workspace.sources()));
  }

  private margins(): Promise<void> {
    const environment = this.environment.value || undefined;
    return this.report(() => this.engine.request("margins", { ...this.workspace.sources(), environment }));
  }

  private async report(request: () => Promise<{ text: string }>): Promise<void> {
    await this.answer(async () => {
      const { text } = await request();
      return () => this.listing.replaceChildren(...text.split("\n").map(reportLine));
    });
  }

  /** Shows what a request brings, unless the program or the question has changed meanwhile. */
  private async answer(request: () => Promise<() => void>): Promise<void> {
    this.show({});
    this.say("One moment …");
    const [version, asked] = [this.workspace.version, ++this.asked];
    const isLast = () => version === this.workspace.version && asked === this.asked;
    try {
      const show = await request();
      if (isLast()) {
        this.say("");
        show();
      }
    } catch (problem) {
      if (isLast()) {
        this.say(inWords(problem), true);
      }
    }
  }

  private say(text: string, bad = false): void {
    this.note.textContent = text;
    this.note.classList.toggle("bad", bad);
    this.note.hidden = text === "";
  }

  private show(files: Record<string, string>): void {
    this.files = files;
    const names = Object.keys(files).sort();
    this.download.disabled = names.length === 0;
    const buttons = names.map((name) => button(name, () => this.choose(name, buttons), { class: "link" }));
    this.list.replaceChildren(...buttons.map((each) => h("li", {}, each)));
    this.listing.textContent = "";
    const stem = this.stem();
    const first = names.find((name) => new RegExp(`(?:^|/)${stem}\\.(?:c|py)$`).test(name)) ?? names[0];
    if (first !== undefined) {
      this.choose(first, buttons);
    }
  }

  private choose(name: string, buttons: readonly HTMLButtonElement[]): void {
    this.listing.textContent = this.files[name] ?? "";
    this.listing.scrollTo(0, 0);
    for (const each of buttons) {
      each.setAttribute("aria-pressed", String(each.textContent === name));
    }
  }

  /** The name of the program, as file names have it. */
  private stem(): string {
    const name = this.workspace.program.main.replace(/^.*\//, "").replace(/\.csp$/, "");
    return name.replaceAll(/[^A-Za-z0-9_-]/g, "_");
  }

  private save(): void {
    const { name, content, advice } = archive(this.files, this.stem(), this.made);
    const address = URL.createObjectURL(new Blob([content], { type: "application/zip" }));
    h("a", { href: address, download: name }).click();
    this.say(advice);
    setTimeout(() => URL.revokeObjectURL(address), 10_000);
  }
}
