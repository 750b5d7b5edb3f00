// For development and the tests: serves build/, and starts an engine on this machine for each page that connects.
//   node dev/server.mjs [--port 8000] [--engine "python -m cspdiag.studio.engine"]
import { spawn } from "node:child_process";
import { readFile } from "node:fs/promises";
import { createServer } from "node:http";
import path from "node:path";
import { createInterface } from "node:readline";
import { fileURLToPath } from "node:url";
import { WebSocketServer } from "ws";

const ROOT = path.join(import.meta.dirname, "..");
const PYTHON = path.join(ROOT, "../.venv/bin/python");
// No more than every server knows: the page has to work on all of them.
const TYPES = { ".html": "text/html; charset=utf-8", ".js": "text/javascript", ".css": "text/css" };

async function page(request, response) {
  const { pathname } = new URL(request.url, "http://localhost");
  const file = path.join(ROOT, "build", path.normalize(pathname === "/" ? "/index.html" : pathname));
  try {
    const content = await readFile(file);
    response.writeHead(200, { "Content-Type": TYPES[path.extname(file)] ?? "application/octet-stream" });
    response.end(content);
  } catch {
    response.writeHead(404).end();
  }
}

/** Carries each line of the engine to the page, and each request of the page to the engine. */
function connect(socket, command) {
  const [program, ...rest] = command;
  const engine = spawn(program, rest, { cwd: path.join(ROOT, ".."), stdio: ["pipe", "pipe", "inherit"] });
  createInterface({ input: engine.stdout }).on("line", (line) => socket.send(line));
  socket.on("message", (data) => {
    const { id, method } = JSON.parse(data);
    if (id !== undefined) engine.stdin.write(`${data}\n`);
    else if (method === "ping") socket.send(JSON.stringify({ method: "pong" }));
  });
  socket.on("close", () => engine.kill());
  engine.stdin.on("error", () => socket.close());
  engine.on("exit", () => socket.close(1011, "the engine has ended"));
}

/** Serves until `close` of the result; `port` 0 is a free one. */
export async function serve({ port = 0, command = [PYTHON, "-m", "cspdiag.studio.engine"] } = {}) {
  const server = createServer((request, response) => void page(request, response));
  const sockets = new WebSocketServer({ server, path: "/engine" });
  sockets.on("connection", (socket) => connect(socket, command));
  await new Promise((resolve) => server.listen(port, "127.0.0.1", resolve));
  return {
    address: `http://127.0.0.1:${server.address().port}/?token=development`,
    close: () => {
      for (const socket of sockets.clients) socket.terminate();
      server.closeAllConnections();
      return new Promise((resolve) => server.close(resolve));
    },
  };
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const option = (name) => process.argv[process.argv.indexOf(name) + 1];
  const port = process.argv.includes("--port") ? Number(option("--port")) : 8000;
  const command = process.argv.includes("--engine") ? option("--engine").split(" ") : undefined;
  const { address } = await serve({ port, command });
  console.log(`open ${address}`);
}
