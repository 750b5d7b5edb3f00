/** The list of what was found in the program, with help, both ends, and what fixes it. */

import type { Finding, Fix, Place } from "../engine/messages";
import { button, element, h } from "../page/dom";
import { inline } from "../page/markdown";

export interface Actions {
  go: (place: Place) => void;
  fix: (fix: Fix) => void;
  explain: (code: string) => void;
}

function where(place: Place): string {
  return `${place.file}:${place.start.line + 1}:${place.start.character + 1}`;
}

export class Problems {
  private readonly room = element("problems", HTMLElement);
  private readonly summary = element("problem-count", HTMLElement);

  constructor(private readonly actions: Actions) {}

  show(findings: readonly Finding[]): void {
    this.room.replaceChildren(...findings.map((finding) => this.row(finding)));
    const errors = findings.filter((finding) => finding.severity === "error").length;
    const others = findings.length - errors;
    const count = (n: number, word: string) => (n === 0 ? [] : [`${n} ${word}${n === 1 ? "" : "s"}`]);
    this.summary.textContent = [...count(errors, "error"), ...count(others, "warning")].join(", ") || "No problems";
    this.summary.className = errors > 0 ? "bad" : others > 0 ? "odd" : "good";
  }

  private row(finding: Finding): HTMLElement {
    const { code, place, help } = finding;
    const go = place === null ? undefined : button(where(place), () => this.actions.go(place), { class: "link place" });
    const explain =
      code === null ? undefined : button(code, () => this.actions.explain(code), { class: "code", title: `What ${code} means` });
    return h(
      "li",
      { class: finding.severity },
      h("div", { class: "first" }, h("span", { class: "severity" }, finding.severity), explain, h("span", { class: "message" }, ...inline(finding.message)), go),
      help == null || help === "" ? undefined : h("p", { class: "help" }, ...inline(help)),
      ...finding.related.map((each) =>
        h("p", { class: "related" }, ...inline(each.message), " ", button(where(each.place), () => this.actions.go(each.place), { class: "link place" })),
      ),
      ...finding.fixes.map((fix) => button(inline(fix.title), () => this.actions.fix(fix), { class: "fix" })),
    );
  }
}
