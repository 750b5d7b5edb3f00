/** The little Markdown that hovers and manual pages use, as elements: paragraphs, headings, lists, code. */

import { h } from "./dom";

/** Texts with code in backticks and bold in asterisks. */
export function inline(text: string): (string | Node)[] {
  return text.split(/(`[^`]+`|\*\*[^*]+\*\*)/).map((part) => {
    if (part.startsWith("`") && part.length > 2) {
      return h("code", {}, part.slice(1, -1));
    }
    return part.startsWith("**") && part.length > 4 ? h("strong", {}, part.slice(2, -2)) : part;
  });
}

function block(text: string): HTMLElement {
  const heading = /^#+\s+(.*)$/.exec(text);
  if (heading !== null) {
    return h("h3", {}, ...inline(heading[1] ?? ""));
  }
  if (/^[-*] /.test(text)) {
    const points = text.split(/\n(?=[-*] )/);
    return h("ul", {}, ...points.map((point) => h("li", {}, ...inline(point.slice(2).replaceAll("\n", " ")))));
  }
  return h("p", {}, ...inline(text.replaceAll("\n", " ")));
}

export function markdown(text: string, name = "markdown"): HTMLElement {
  const parts = text.split(/^(```[^\n]*\n[\s\S]*?^```\s*$)/m);
  const blocks = parts.flatMap((part) => {
    if (part.startsWith("```")) {
      return [h("pre", {}, part.replace(/^```[^\n]*\n/, "").replace(/\n?```\s*$/, ""))];
    }
    return part
      .split(/\n\s*\n|\n(?=#)/)
      .filter((each) => each.trim() !== "")
      .map((each) => block(each.trim()));
  });
  return h("div", { class: name }, ...blocks);
}
