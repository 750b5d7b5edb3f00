/** Which cspdiag to start. Nothing here knows VS Code, so that it can be tested alone. */

import * as path from "node:path";

/** What the search depends on. */
export interface Surroundings {
  /** The setting `cspdiag.path`; empty if it is not set. */
  setting: string;
  /** The paths of the open folders. */
  folders: readonly string[];
  /** Whether the user trusts the folders: what lies in others is not started. */
  trusted: boolean;
  /** The Python interpreter that was chosen in the Python extension. */
  interpreter?: string | undefined;
  /** Where this extension installs cspdiag if no folder is open. */
  storage: string;
  home: string;
  /** The environment variable PATH. */
  searchPath: string;
  platform: NodeJS.Platform;
  /** Whether a path is that of a file. */
  exists: (file: string) => boolean;
}

/** A cspdiag that is there, and in words where it was found. */
export interface Found {
  command: string;
  from: string;
}

/** The first cspdiag that is there, in the order of the documentation; undefined if there is none. */
export function find(around: Surroundings): Found | undefined {
  if (around.setting.trim() !== "") {
    const command = expanded(around.setting, around);
    return around.exists(command) ? { command, from: "the setting cspdiag.path" } : undefined;
  }
  return candidates(around).find((candidate) => around.exists(candidate.command));
}

function candidates(around: Surroundings): Found[] {
  const paths = pathsOf(around);
  const found: Found[] = [];
  if (around.interpreter !== undefined && around.trusted) {
    const command = paths.join(paths.dirname(around.interpreter), executable(around));
    found.push({ command, from: "the interpreter of the Python extension" });
  }
  if (around.trusted) {
    for (const folder of around.folders) {
      for (const name of [".venv", "venv"]) {
        found.push({ command: inEnvironment(paths.join(folder, name), around), from: paths.join(folder, name) });
      }
    }
  }
  found.push({ command: inEnvironment(around.storage, around), from: "the folder of this extension" });
  const separator = around.platform === "win32" ? ";" : ":";
  for (const folder of around.searchPath.split(separator).filter((each) => paths.isAbsolute(each))) {
    found.push({ command: paths.join(folder, executable(around)), from: "the PATH" });
  }
  return found;
}

/** The path in the setting, with `~` and `${workspaceFolder}` replaced; one that is relative begins in the folder. */
export function expanded(setting: string, around: Surroundings): string {
  const folder = around.folders[0] ?? around.home;
  const named = setting.trim().replace(/^~(?=[/\\]|$)/, () => around.home);
  return pathsOf(around).resolve(folder, named.replaceAll("${workspaceFolder}", () => folder));
}

/** The cspdiag of a virtual environment. */
export function inEnvironment(folder: string, around: Pick<Surroundings, "platform">): string {
  return pathsOf(around).join(folder, around.platform === "win32" ? "Scripts" : "bin", executable(around));
}

function executable(around: Pick<Surroundings, "platform">): string {
  return around.platform === "win32" ? "cspdiag.exe" : "cspdiag";
}

function pathsOf(around: Pick<Surroundings, "platform">): path.PlatformPath {
  return around.platform === "win32" ? path.win32 : path.posix;
}
