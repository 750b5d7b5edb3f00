/** A link may hold anybody's program. What it has in other languages is run when one has agreed to that. */

import { type Engine, inWords } from "../engine/engine";
import type { Body } from "../engine/messages";
import { button, element, h } from "../page/dom";
import type { Workspace } from "./workspace";

const LANGUAGES: Record<string, string> = { python: "Python", c: "C", fmu: "FMU", device: "Device" };
const ON_MACHINE = "On this machine it may do whatever you may: read, change and send your files. Run it only if you trust who made the link.";
const IN_BROWSER = "It runs in this browser, and reaches neither your files nor another server. Run it only if you trust who made the link.";

export class Trust {
  private readonly dialog = element("ask", HTMLDialogElement);
  private readonly body = element("ask-body", HTMLElement);
  /** Whether the program is that of a link, and nobody has agreed to run it. */
  private unknown = false;
  private asking = false;
  private answer: (runs: boolean) => void = () => undefined;
  /** Whether programs run on the machine of the user. */
  onMachine = true;

  constructor(
    private readonly engine: Engine,
    private readonly workspace: Workspace,
    private readonly look: (file: string) => void,
    private readonly report: (text: string) => void,
  ) {
    element("ask-yes", HTMLButtonElement).addEventListener("click", () => this.close(true));
    element("ask-no", HTMLButtonElement).addEventListener("click", () => this.close(false));
    this.dialog.addEventListener("close", () => this.close(false));
  }

  /** Another program is opened. */
  opens(linked: boolean): void {
    this.close(false);
    this.unknown = linked;
  }

  /** Whether the program may be run; asks the user if it has to. */
  async mayRun(): Promise<boolean> {
    if (!this.unknown || this.asking) {
      return !this.unknown;
    }
    this.asking = true;
    try {
      return await this.agreed();
    } catch (problem) {
      this.report(inWords(problem));
      return false;
    } finally {
      this.asking = false;
    }
  }

  private async agreed(): Promise<boolean> {
    const { version } = this.workspace;
    const { bodies } = await this.engine.request("check", this.workspace.sources());
    return version === this.workspace.version && (bodies.length === 0 || this.ask(bodies));
  }

  private ask(bodies: readonly Body[]): Promise<boolean> {
    this.body.replaceChildren(
      h("h2", { id: "ui-ask-title" }, "Run the code that came by this link?"),
      h("p", {}, "Besides its diagrams, the program of this link has code and devices that they do not show:"),
      h("ul", {}, ...bodies.map((body) => this.row(body))),
      h("p", {}, this.onMachine ? ON_MACHINE : IN_BROWSER),
    );
    this.dialog.showModal();
    return new Promise((resolve) => (this.answer = resolve));
  }

  private row({ language, target, files }: Body): HTMLElement {
    const own = files.filter((file) => file in this.workspace.program.files);
    const looks = own.map((file) => button(`Look at ${file}`, () => this.show(file)));
    return h("li", {}, `${LANGUAGES[language] ?? language}: `, h("code", {}, target), " ", ...looks);
  }

  private show(file: string): void {
    this.close(false);
    this.look(file);
  }

  private close(runs: boolean): void {
    const { answer } = this;
    this.answer = () => undefined;
    this.unknown &&= !runs;
    this.dialog.close();
    answer(runs);
  }
}
