/** Who waits for whom, in words. */

import type { Waiting } from "../engine/messages";
import { h } from "../page/dom";

export function sentence({ process, channels, for: what }: Waiting): string {
  const where = channels.length === 0 ? "" : ` on ${channels.join(", ")}`;
  if (what == null || what === "") {
    return `${process} waits${where}`;
  }
  return /\bwait/.test(what) ? `${process} ${what}` : `${process} waits${where} for ${what}`;
}

export function list(waiting: readonly Waiting[]): HTMLElement {
  return h("ul", { class: "waits" }, ...waiting.map((each) => h("li", {}, sentence(each))));
}
