/** How snippets begin. Nothing here knows VS Code, so that it can be tested alone. */

/** The first word of a text, after comments that document it. */
export function beginning(text: string): string {
  return /^(?:\/\/.*\n)*(\w+)/.exec(text)?.[1] ?? "";
}
