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

export function list(waiting: readonly Waiting[]): HTMLElement {
  const top = common(waiting.map((each) => each.process));
  return h("ul", { class: "waits", tabindex: "0", "aria-label": "Who waits" }, ...waiting.map((each) => h("li", {}, sentence(each).replaceAll(top, ""))));
}
