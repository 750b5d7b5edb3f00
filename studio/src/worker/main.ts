/** The engine in a worker of the browser: Python as WebAssembly, which answers what the page asks. */

import { layoutRunner } from "./layout";
import { loadPython, type PythonEngine } from "./python";

interface Scope {
  onmessage: ((event: { data: unknown }) => void) | null;
  postMessage: (message: unknown) => void;
}

const scope = self as unknown as Scope;
const base = new URL("engine/", import.meta.url).href;

/** Lets the program run between the requests, when the engine says so. */
function proceed(engine: PythonEngine): void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  const plan = (): void => {
    clearTimeout(timer);
    const due = engine.due();
    if (due !== undefined) {
      timer = setTimeout(() => {
        engine.proceed();
        plan();
      }, due * 1000);
    }
  };
  scope.onmessage = (event) => {
    scope.postMessage(engine.request(event.data));
    plan();
  };
}

async function main(): Promise<void> {
  const early: unknown[] = [];
  scope.onmessage = (event) => early.push(event.data);
  try {
    // A worker that is a module, as Pyodide needs it, has no importScripts: the layout engine is there from the beginning.
    const [engine] = await Promise.all([
      loadPython(base, layoutRunner(() => undefined), (message) => scope.postMessage(message)),
      import(`${base}elk.js`),
    ]);
    proceed(engine);
    scope.postMessage({ method: "ready", params: {} });
  } catch (problem) {
    const reason = problem instanceof Error ? problem.message : String(problem);
    const refuse = (request: unknown): void => {
      const id = (request as { id?: number }).id;
      scope.postMessage({ id, error: { message: `the engine cannot be loaded: ${reason}` } });
    };
    early.splice(0).forEach(refuse);
    scope.onmessage = (event) => refuse(event.data);
    return;
  }
  for (const data of early) {
    scope.onmessage({ data });
  }
}

void main();
