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

/** What a command for a run printed to standard error, and the signal that ended it, if one did. */
export interface Printed {
  errors: string;
  signal: string | null;
}

/** How a run has ended, or why there was none, without what the lens is at, the `folder` of the program included.
 * `time` is the setting for how long it runs. */
export function outcome({ errors, signal }: Printed, environment: string, time: string, folder: string): string {
  const lines = errors.split("\n").map((line) => line.trimEnd());
  const ending = endingOf(lines, environment);
  if (ending !== undefined) {
    return ending;
  }
  if (signal !== null) {
    return `ended by ${signal}`;
  }
  const line = without(folder, reasonIn(lines));
  const isTime = [`\`${time}\` is not a time`, `a run cannot last ${time}`].some((each) => line.includes(each));
  return isTime ? `The setting cspdiag.run.for: ${line}` : line;
}

/** How a run ended, as its summary says, which comes last; undefined if there was none. The report of a deadlock, before
 * it, begins with the same words and says more. */
function endingOf(lines: readonly string[], environment: string): string | undefined {
  const found = lines.map((line) => /^\w+ in (\w+): (.+)$/.exec(line)).findLast((each) => each?.[1] === environment);
  const ending = found?.[2];
  return lines.find((line) => ending !== undefined && line.startsWith(`${ending}: `)) ?? ending;
}

/** Why there was no run: the error that ended the command, or the first one in the program, whatever was warned of or
 * printed before. */
function reasonIn(lines: readonly string[]): string {
  const error = lines.find((line) => line.startsWith("error["));
  return lastComplaint(lines) ?? error ?? lines.find((line) => line !== "") ?? "ended without a word";
}

/** The last thing that the command could not do, such as writing a figure. */
export function lastComplaint(lines: readonly string[]): string | undefined {
  return lines.findLast((line) => line.startsWith("cspdiag: "))?.replace(/^cspdiag: /, "");
}

/** What is shown beside the button that cancels a run, of lines that it has printed; undefined if nothing is. */
export function complaintDuring(lines: readonly string[], folder: string): string | undefined {
  const line = lastComplaint(lines);
  return line === undefined ? undefined : without(folder, line).replace("Ctrl-C ends", "Cancel ends");
}

function without(folder: string, line: string): string {
  return line.replaceAll(folder.endsWith(sep) ? folder : folder + sep, "");
}

/** What a run of a program said. */
export interface Result {
  /** The fingerprint of the program that was run, its imported files included. */
  program: string;
  outcome: string;
}

/** What is said of a run that has not ended. */
export const RUNNING = "running…";

/** The title of the lens of a run; `now` is the fingerprint of the program as it is now. */
export function titleOf({ program, outcome }: Result, now: unknown): string {
  return program === now ? outcome : `before the change: ${outcome}`;
}
