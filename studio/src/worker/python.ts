/** Python with cspdiag in it. */

/** What of Pyodide is used (https://pyodide.org/en/stable/usage/api/js-api.html). */
interface Pyodide {
  unpackArchive: (buffer: ArrayBuffer, format: string, options: { extractDir: string }) => void;
  runPython: (code: string) => unknown;
  toPy: (value: unknown) => unknown;
  globals: { set: (name: string, value: unknown) => void };
}

interface Module {
  loadPyodide: () => Promise<Pyodide>;
}

/** The functions of `cspdiag.studio.browser`. */
interface Functions {
  request: (text: string) => string;
  due: () => number | undefined;
  proceed: () => void;
}

export interface PythonEngine {
  request: (message: unknown) => unknown;
  /** In how many seconds `proceed` is to be called. */
  due: () => number | undefined;
  proceed: () => void;
}

const FOLDER = "/cspdiag";

export async function loadPython(base: string, layout: (graph: string) => string, notify: (message: unknown) => void): Promise<PythonEngine> {
  const [module, archive] = await Promise.all([import(`${base}pyodide.mjs`) as Promise<Module>, read(`${base}cspdiag.zip`)]);
  const python = await module.loadPyodide();
  python.unpackArchive(archive, "zip", { extractDir: FOLDER });
  python.globals.set("_layout", layout);
  python.globals.set("_notify", (text: string) => notify(JSON.parse(text)));
  const functions = python.runPython(`
import os, sys
os.environ["XDG_CACHE_HOME"] = "${FOLDER}/.cache"
sys.path.insert(0, "${FOLDER}")
sys.dont_write_bytecode = True
from cspdiag.studio.browser import Functions
Functions(_layout, _notify)
`) as Functions;
  return {
    request: (message) => JSON.parse(functions.request(JSON.stringify(message))) as unknown,
    due: () => functions.due() ?? undefined,
    proceed: () => functions.proceed(),
  };
}

async function read(url: string): Promise<ArrayBuffer> {
  const answer = await fetch(url);
  if (!answer.ok) {
    throw new Error(`${url}: ${answer.status}`);
  }
  return answer.arrayBuffer();
}
