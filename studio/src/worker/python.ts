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
  const progress = (doing: string): void => notify({ method: "starting", params: { doing } });
  progress("loading Python");
  const loaded = import(`${base}pyodide.js`) as Promise<Module>;
  const [module, archive] = await Promise.all([loaded, read(`${base}cspdiag.zip`)]);
  progress("starting Python");
  const python = await Promise.race([unstartable(), module.loadPyodide()]);
  progress("starting cspdiag");
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

/**
 * Fails when WebAssembly does not start, for which Pyodide would wait forever. It starts from servers, too, that do not
 * know its type, which browsers refuse.
 */
function unstartable(): Promise<never> {
  if (typeof WebAssembly.instantiateStreaming !== "function") {
    return new Promise(() => undefined);
  }
  const streaming = WebAssembly.instantiateStreaming.bind(WebAssembly);
  const start = async (source: Response | PromiseLike<Response>, imports?: WebAssembly.Imports): Promise<WebAssembly.WebAssemblyInstantiatedSource> => {
    const response = await source;
    if (!response.ok) {
      throw new Error(`${response.url}: ${response.status}`);
    }
    const isKnown = response.headers.get("Content-Type") === "application/wasm";
    return isKnown ? streaming(response, imports) : WebAssembly.instantiate(await response.arrayBuffer(), imports);
  };
  return new Promise((_, reject) => {
    WebAssembly.instantiateStreaming = (source, imports) => {
      const started = start(source, imports);
      started.catch(reject);
      return started;
    };
  });
}

async function read(url: string): Promise<ArrayBuffer> {
  const answer = await fetch(url);
  if (!answer.ok) {
    throw new Error(`${url}: ${answer.status}`);
  }
  return answer.arrayBuffer();
}
