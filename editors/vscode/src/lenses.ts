/** Lenses as short as the editor needs them. Nothing here knows VS Code, so that it can be tested alone. */

import { sep } from "node:path";

/** The longest title, in characters: the editor cuts lenses that are wider than it at their beginning. */
const LONGEST = 48;

/** A title that is not too long, with the whole as its tooltip if it was. */
export function brief(title: string): { title: string; tooltip?: string } {
  if (title.length <= LONGEST) {
    return { title };
  }
  const words = title.slice(0, LONGEST - 1);
  const end = words.lastIndexOf(" ");
  return { title: `${words.slice(0, end > LONGEST / 2 ? end : undefined)}…`, tooltip: title };
}

/** How a run has ended, or why there was none: the first line of what it printed, without what the lens is at, the
 * `folder` of the program included. `time` is the setting for how long it runs. */
export function outcome(output: string, environment: string, time: string, folder: string): string {
  const printed = output.split("\n").find((each) => each.trim() !== "") ?? "ended without a word";
  const line = printed.replace(/^cspdiag: /, "").replaceAll(folder.endsWith(sep) ? folder : folder + sep, "");
  if ([`\`${time}\` is not a time`, `a run cannot last ${time}`].some((each) => line.includes(each))) {
    return `The setting cspdiag.run.for: ${line}`;
  }
  const start = line.indexOf(` in ${environment}: `);
  return /^\w+$/.test(line.slice(0, Math.max(start, 0))) ? line.slice(start + ` in ${environment}: `.length) : line;
}

/** What a run of a program said. */
export interface Result {
  /** The fingerprint of the program that was run, its imported files included. */
  program: string;
  outcome: string;
}

/** The title of the lens of a run; `now` is the fingerprint of the program as it is now. */
export function titleOf({ program, outcome }: Result, now: unknown): string {
  return program === now ? outcome : `before the change: ${outcome}`;
}
