// Runs build/worker.js in node, as a browser runs it in a worker: requests and answers are lines of JSON.
import { readFileSync } from "node:fs";
import { createInterface } from "node:readline";
import { fileURLToPath } from "node:url";

globalThis.self = globalThis;
globalThis.fetch = async (url) => new Response(readFileSync(fileURLToPath(url)));
globalThis.postMessage = (message) => process.stdout.write(`${JSON.stringify(message)}\n`);
await import(new URL("../../build/worker.js", import.meta.url));
for await (const line of createInterface({ input: process.stdin })) {
  globalThis.onmessage({ data: JSON.parse(line) });
}
