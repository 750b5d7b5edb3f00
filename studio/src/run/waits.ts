/** Which processes wait for which, in words. */

import type { Waiting } from "../engine/messages";
import { h } from "../page/dom";

export function sentence({ process, channels, for: what, partners, why = "" }: Waiting): string {
  const where = channels.length === 0 ? "" : ` on ${channels.join(", ")}`;
  const whom = partners != null && partners.length > 0 ? `, for ${partners.join(", ")}` : "";
  if (what == null || what === "") {
    return `${process} waits${where}${whom}${why}`;
  }
  const verb = /^(waits|ends|is)\b/.test(what) ? "" : what.startsWith("in ") ? "is " : "waits ";
  return `${process} ${verb}${what}${whom}${why}`;
}

/** What all paths begin with: the name of the whole program and a dot; without paths nothing that occurs in texts. */
function common(paths: readonly string[]): string {
  const first = /^[^.]*\./.exec(paths[0] ?? "")?.[0];
  return first !== undefined && paths.length > 1 && paths.every((path) => path.startsWith(first)) ? first : "\0";
}

/** Processes of which each waits for the next, and the last for the first; none if there is no such ring. */
export function ring(waiting: readonly Waiting[]): string[] {
  const whom = new Map(waiting.map((each) => [each.process, each.partners ?? []]));
  const done = new Set<string>();
  for (const first of whom.keys()) {
    const way: string[] = [];
    let at: string | undefined = first;
    while (at !== undefined && !done.has(at)) {
      done.add(at);
      way.push(at);
      at = whom.get(at)?.find((each) => whom.has(each));
    }
    const begin = at === undefined ? -1 : way.indexOf(at);
    if (begin >= 0) {
      return way.slice(begin);
    }
  }
  return [];
}

/** The ring of a deadlock and the processes beside it in one sentence; empty without a ring. */
export function summary(waiting: readonly Waiting[]): string {
  const members = ring(waiting);
  const [first = ""] = members;
  if (members.length < 2) {
    return "";
  }
  const beside = waiting.map((each) => each.process).filter((each) => !members.includes(each));
  const circle = members.length === 2 ? `${members.join(" and ")} wait for each other` : `In a ring each waits for the next: ${members.join(", ")}, and that again for ${first}`;
  const others = beside.length === 0 ? "" : `; beside them ${beside.join(", ")} ${beside.length === 1 ? "waits" : "wait"}, too`;
  return `${circle}${others}.`;
}

/** Who waits for whom: first in a sentence, then one by one. */
export function list(waiting: readonly Waiting[]): HTMLElement {
  const top = common(waiting.map((each) => each.process));
  const short = (text: string) => text.replaceAll(top, "");
  const whole = summary(waiting);
  return h(
    "div",
    { class: "who-waits" },
    whole === "" ? "" : h("p", {}, short(whole)),
    h("ul", { class: "waits", tabindex: "0", "aria-label": "Who waits" }, ...waiting.map((each) => h("li", {}, short(sentence(each))))),
  );
}
