/** Assertions and their answers; a counterexample is shown as a film in the diagram. */

import type { Diagram } from "../diagram/diagram";
import { type Engine, inWords } from "../engine/engine";
import type { Answer, Assertion, Counterexample, Fix, Place, Suggestion } from "../engine/messages";
import { button, element, h } from "../page/dom";
import { inline } from "../page/markdown";
import type { Trust } from "../program/trust";
import type { Workspace } from "../program/workspace";
import { Film, scenes } from "./film";

const SIGNS: Record<string, string> = { holds: "✓", fails: "✗", unknown: "?" };

/** That a suggestion was proved for some value of a constant only. */
function only({ proved_with: setting }: Suggestion): string[] {
  return setting == null ? [] : [` (proved with ${setting} only)`];
}

export class Proofs {
  private readonly room = element("assertions", HTMLElement);
  private readonly note = element("proof-note", HTMLElement);
  private readonly prove = element("prove", HTMLButtonElement);
  private readonly film: Film;
  private assertions: Assertion[] = [];
  private answers: Answer[] = [];
  private version = -1;
  private busy = false;
  /** Counts what was asked, and says which of that was cancelled. */
  private asked = 0;
  private cancelled = 0;

  constructor(
    private readonly engine: Engine,
    private readonly workspace: Workspace,
    diagram: Diagram,
    private readonly trust: Trust,
    private readonly go: (place: Place) => void,
    private readonly fix: (fix: Fix) => void,
  ) {
    this.film = new Film(element("film", HTMLElement), diagram);
    this.prove.addEventListener("click", () => void this.ask());
  }

  /** The assertions of the program as it is now; answers for another text are not kept. */
  show(assertions: Assertion[]): void {
    this.assertions = assertions;
    if (this.version !== this.workspace.version) {
      this.answers = [];
      this.film.close();
      this.say("");
    }
    this.paint();
  }

  private async ask(): Promise<void> {
    if (this.busy) {
      this.cancelled = this.asked;
      await this.engine.request("cancel", {}).catch(() => undefined);
      return;
    }
    // Counterexamples are confirmed by runs.
    if (!(await this.trust.mayRun())) {
      return;
    }
    this.busy = true;
    const asked = ++this.asked;
    this.prove.textContent = "Cancel";
    this.say("Proving …");
    this.paint();
    const version = this.workspace.version;
    try {
      const answers = await this.engine.request("verify", this.workspace.sources());
      if (version === this.workspace.version) {
        [this.answers, this.version] = [answers, version];
      }
      this.say("");
    } catch (problem) {
      this.say(this.cancelled === asked ? "Cancelled." : inWords(problem));
    }
    this.busy = false;
    this.prove.textContent = "Prove all";
    this.paint();
  }

  private say(text: string): void {
    this.note.textContent = text;
    this.note.hidden = text === "";
  }

  private paint(): void {
    if (this.answers.length > 0) {
      this.room.replaceChildren(...this.answers.map((answer) => this.answered(answer)));
      return;
    }
    const rows = this.assertions.map(({ text, place }) =>
      h("li", {}, h("span", { class: "verdict", "aria-hidden": "true" }, "·"), button(text, () => this.go(place), { class: "link" })),
    );
    const write = ["This program asserts nothing: it is asked whether it can deadlock or livelock. Write ", h("code", {}, "assert Name deadlock free"), " or the like at its end."];
    const none = this.busy ? [] : [h("li", {}, h("p", { class: "hint" }, ...write))];
    this.room.replaceChildren(...(rows.length > 0 ? rows : none));
  }

  private answered(answer: Answer): HTMLElement {
    const { suggestions = [], counterexample, place } = answer;
    const title =
      place == null ? h("b", {}, answer.assertion) : button(answer.assertion, () => this.go(place), { class: "link" });
    return h(
      "li",
      { class: answer.verdict },
      h("span", { class: "verdict", "aria-hidden": "true" }, SIGNS[answer.verdict] ?? "?"),
      h(
        "div",
        {},
        title,
        h("span", { class: "word" }, answer.verdict),
        h("p", {}, ...inline(answer.text)),
        counterexample == null || scenes(counterexample).length === 0
          ? undefined
          : button("Show the counterexample", () => this.play(answer.assertion, counterexample)),
        suggestions.length === 0 ? undefined : h("p", { class: "hint" }, suggestions.length === 1 ? "Proved after this change:" : "Proved after one of these changes:"),
        ...suggestions.map((each) => button([...inline(each.title), ...only(each)], () => this.fix(each))),
      ),
    );
  }

  private play(title: string, counterexample: Counterexample): void {
    this.film.open(title, counterexample);
  }
}
