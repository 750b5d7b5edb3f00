import assert from "node:assert/strict";
import { test } from "node:test";
import type { Surroundings } from "../../src/find";
import { find } from "../../src/find";

function around(there: string[], changes: Partial<Surroundings> = {}): Surroundings {
  return {
    setting: "",
    folders: ["/project #1"],
    trusted: true,
    storage: "/storage/venv",
    home: "/home/ada",
    searchPath: "/usr/local/bin:/usr/bin",
    platform: "linux",
    exists: (file) => there.includes(file),
    ...changes,
  };
}

const EVERYWHERE = [
  "/project #1/.venv/bin/cspdiag",
  "/project #1/venv/bin/cspdiag",
  "/storage/venv/bin/cspdiag",
  "/usr/bin/cspdiag",
];

test("the environment of the folder comes before the PATH", () => {
  assert.equal(find(around(EVERYWHERE))?.command, "/project #1/.venv/bin/cspdiag");
  assert.equal(find(around(EVERYWHERE.slice(1)))?.command, "/project #1/venv/bin/cspdiag");
  assert.equal(find(around(EVERYWHERE.slice(3)))?.command, "/usr/bin/cspdiag");
  assert.equal(find(around([])), undefined);
});

test("the interpreter of the Python extension comes first", () => {
  const interpreter = "/opt/env/bin/python";
  assert.equal(find(around(["/opt/env/bin/cspdiag", ...EVERYWHERE], { interpreter }))?.command, "/opt/env/bin/cspdiag");
  assert.equal(find(around(EVERYWHERE, { interpreter }))?.command, EVERYWHERE[0]);
});

test("nothing of a folder that is not trusted is started", () => {
  const changes = { trusted: false, interpreter: "/project #1/.venv/bin/python" };
  assert.equal(find(around(EVERYWHERE, changes))?.command, "/storage/venv/bin/cspdiag");
});

test("what the setting names is taken, or nothing", () => {
  const found = (setting: string, there: string[]) => find(around([...there, ...EVERYWHERE], { setting }))?.command;
  assert.equal(found("~/env/bin/cspdiag", ["/home/ada/env/bin/cspdiag"]), "/home/ada/env/bin/cspdiag");
  assert.equal(found("${workspaceFolder}/c$&", ["/project #1/c$&"]), "/project #1/c$&");
  assert.equal(found("env/bin/cspdiag", ["/project #1/env/bin/cspdiag"]), "/project #1/env/bin/cspdiag");
  assert.equal(found("../cspdiag", ["/cspdiag"]), "/cspdiag");
  assert.equal(found("/not/there", []), undefined);
});

test("Windows has other names", () => {
  const command = "C:\\work\\.venv\\Scripts\\cspdiag.exe";
  assert.equal(find(around([command], { platform: "win32", folders: ["C:\\work"] }))?.command, command);
});

test("relative folders in the PATH are left out: they depend on where the editor was started", () => {
  assert.equal(find(around(["./cspdiag", "cspdiag"], { searchPath: ".:" })), undefined);
});
