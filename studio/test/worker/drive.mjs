// Runs build/worker.js in node, as a browser runs it in a worker: requests and answers are lines of JSON.
import { readFileSync } from "node:fs";
import { createInterface } from "node:readline";
import { pathToFileURL, fileURLToPath } from "node:url";
import { runInThisContext } from "node:vm";
import { constants } from "node:vm";

const build = new URL("../../build/", import.meta.url);
const code = (url) => readFileSync(fileURLToPath(url), "utf8");
globalThis.self = globalThis;
globalThis.location = { href: new URL("worker.js", build).href };
globalThis.fetch = async (url) => new Response(readFileSync(fileURLToPath(url)));
globalThis.postMessage = (message) => process.stdout.write(`${JSON.stringify(message)}\n`);
runInThisContext(code(new URL("worker.js", build)), {
  filename: fileURLToPath(new URL("worker.js", build)),
  importModuleDynamically: constants.USE_MAIN_CONTEXT_DEFAULT_LOADER,
});
void pathToFileURL;
for await (const line of createInterface({ input: process.stdin })) {
  globalThis.onmessage({ data: JSON.parse(line) });
}
