/** Whether a cspdiag can serve this extension, found out by asking it. */

import { execFile } from "node:child_process";

/** The oldest cspdiag that has everything this extension asks for. */
export const OLDEST = "0.1.0";

/** What is wrong with a cspdiag, in one sentence; `update` says whether another version would help. */
export interface Problem {
  message: string;
  update: boolean;
}

/** How a command has ended; `status` is undefined if it could not be started, or did not end in time (`late`). */
export interface Ended {
  status: number | undefined;
  output: string;
  errors: string;
  late?: boolean;
}

export type Run = (command: string, args: readonly string[]) => Promise<Ended>;

/** Seconds after which a command that has not ended is ended. */
const LONGEST = 20;

/** Runs a command without input; one that takes longer than 20 seconds is ended, and so is one that is given up. */
export function run(command: string, args: readonly string[], givenUp?: AbortSignal, longest = LONGEST): Promise<Ended> {
  const options = { timeout: longest * 1000, killSignal: "SIGKILL", encoding: "utf8", signal: givenUp } as const;
  return new Promise<Ended>((resolve) => {
    // Some reasons for which a command cannot start are thrown, and make a promise that fails.
    const child = execFile(command, args, options, (error, output, errors) => {
      const status = error === null ? 0 : typeof error.code === "number" ? error.code : undefined;
      const said = errors === "" && status === undefined ? (error?.message ?? "") : errors;
      resolve({ status, output, errors: said, late: error?.killed === true && typeof error.code !== "string" });
    });
    child.stdin?.end();
  }).catch((problem: unknown) => ({ status: undefined, output: "", errors: String(problem) }));
}

/** What keeps a cspdiag from serving this extension; undefined if nothing does. */
export async function problemOf(command: string, runs: Run = run): Promise<Problem | undefined> {
  // The server ends at the end of its input, so this takes half a second.
  const [version, server] = await Promise.all([runs(command, ["--version"]), runs(command, ["lsp"])]);
  if (version.late === true || server.late === true) {
    return { message: `${command} did not answer within ${LONGEST} s`, update: false };
  }
  const number = /^cspdiag (\d+(?:\.\d+)*)/.exec(version.output)?.[1];
  if (version.status !== 0 || number === undefined) {
    return { message: `${command} does not start: ${lastLine(version.errors)}`, update: false };
  }
  if (isOlder(number, OLDEST)) {
    return { message: `${command} is version ${number}, and this extension needs ${OLDEST} or newer`, update: true };
  }
  if (/unknown verb|invalid choice/.test(server.errors)) {
    return { message: `${command} is version ${number}, which is too old: it has no language server`, update: true };
  }
  if (/needs (pygls|lsprotocol)/.test(server.errors)) {
    return { message: `${command} was installed without its language server`, update: true };
  }
  if (server.status !== 0) {
    return { message: `the server of ${command} does not start: ${lastLine(server.errors)}`, update: false };
  }
  return undefined;
}

/** Whether a version is older than another; both are numbers with points between them. */
export function isOlder(version: string, other: string): boolean {
  const [left, right] = [version.split(".").map(Number), other.split(".").map(Number)];
  for (let part = 0; part < Math.max(left.length, right.length); part++) {
    const difference = (left[part] ?? 0) - (right[part] ?? 0);
    if (difference !== 0) {
      return difference < 0;
    }
  }
  return false;
}

function lastLine(text: string): string {
  return text.trim().split("\n").at(-1) ?? "";
}
