/** The layout engine, ELK, called like a function. It is written as a worker that answers later; here it answers at once. */

interface Worker {
  postMessage: (message: object) => void;
  onmessage: (message: { data: unknown }) => void;
}

type Define = (
  module: { exports: { Worker?: new () => Worker } },
  exports: object,
  ...surroundings: unknown[]
) => void;

/** A function from a graph, as text, to the graph with places; `load` defines the engine when it is first needed. */
export function layoutRunner(load: () => void): (graph: string) => string {
  let ask: ((message: object) => unknown) | undefined;
  return (graph) => {
    ask ??= start(load);
    const parsed: unknown = JSON.parse(graph);
    const answer = ask({ id: 1, cmd: "layout", graph: parsed, layoutOptions: {}, options: {} }) as { error?: { message?: string } };
    // Errors refer to themselves, so only their message can be passed on.
    return JSON.stringify(answer.error === undefined ? answer : { error: answer.error.message ?? "no layout" });
  };
}

function start(load: () => void): (message: object) => unknown {
  load();
  const define = (globalThis as { layoutEngine?: Define }).layoutEngine;
  if (define === undefined) {
    throw new Error("the layout engine cannot be loaded");
  }
  const jobs: (() => void)[] = [];
  const later = (job: () => void): number => jobs.push(job);
  const nothing = (): void => undefined;
  const module: { exports: { Worker?: new () => Worker } } = { exports: {} };
  // Not derived from the global object of a worker, whose properties refuse to be read through another object.
  const own = Object.getOwnPropertyNames(globalThis).map((name) => [name, (globalThis as Record<string, unknown>)[name]]);
  const timers = { setTimeout: later, setInterval: later, clearTimeout: nothing, clearInterval: nothing };
  const surroundings: object = { ...(Object.fromEntries(own) as Record<string, unknown>), ...timers };
  const console = { log: nothing, warn: nothing, error: nothing };
  define(module, module.exports, surroundings, surroundings, surroundings, undefined, console, later, later, nothing, nothing);
  if (module.exports.Worker === undefined) {
    throw new Error("the layout engine has no worker");
  }
  const worker = new module.exports.Worker();
  const ask = (message: object): unknown => {
    let answer: unknown;
    worker.onmessage = ({ data }) => {
      answer = data;
    };
    worker.postMessage(message);
    for (let job = jobs.shift(); job !== undefined; job = jobs.shift()) {
      job();
    }
    return answer;
  };
  ask({ id: 0, cmd: "register", algorithms: ["layered"] });
  return ask;
}
