// Bundles the page into build/, or, with --tests, the unit tests; nothing is fetched when the page is used.
import { createHash } from "node:crypto";
import { existsSync, mkdirSync, readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { build } from "esbuild";

const production = process.argv.includes("--production");
const shared = { bundle: true, minify: production, sourcemap: !production, logLevel: "warning", metafile: true };
const WORKER = "src/worker/main.ts";

/** The licences of the packages in a bundle, which have to be passed on with it. */
function licences(inputs) {
  const folders = new Set(inputs.map((file) => /.*node_modules\/(?:@[^/]+\/)?[^/]+/.exec(file)?.[0]));
  folders.delete(undefined);
  return [...folders].sort().map((folder) => {
    const file = readdirSync(folder).find((name) => /^licen[cs]e/i.test(name));
    const { name, version } = JSON.parse(readFileSync(`${folder}/package.json`, "utf8"));
    return `${name} ${version}\n\n${file === undefined ? "" : readFileSync(`${folder}/${file}`, "utf8").trim()}\n`;
  });
}

if (process.argv.includes("--tests")) {
  const tests = readdirSync("test/unit").filter((name) => name.endsWith(".test.ts"));
  const node = { ...shared, minify: false, platform: "node", target: "node20", format: "cjs", outExtension: { ".js": ".cjs" } };
  await build({ ...node, entryPoints: tests.map((name) => `test/unit/${name}`), outdir: "build/tests" });
} else {
  for (const name of ["index.html", "main.js", "main.css", "main.js.map", "main.css.map", "worker.js", "LICENCES.txt"]) {
    rmSync(`build/${name}`, { force: true });
  }
  mkdirSync("build", { recursive: true });
  const page = await build({ ...shared, entryPoints: ["src/main.ts", "src/style/main.css"], outdir: "build", entryNames: "main", target: "es2022", format: "iife" });
  const inputs = Object.keys(page.metafile.inputs);
  if (existsSync(WORKER)) {
    const worker = await build({ ...shared, entryPoints: [WORKER], outfile: "build/worker.js", target: "es2022", format: "esm", external: ["node:*"] });
    inputs.push(...Object.keys(worker.metafile.inputs));
  }
  // Allows the editor its own styles, and no others that are not files.
  const nonce = createHash("sha256").update(readFileSync("build/main.js")).digest("base64url").slice(0, 22);
  writeFileSync("build/index.html", readFileSync("index.html", "utf8").replaceAll("NONCE", nonce));
  writeFileSync("build/LICENCES.txt", licences(inputs).join("\n"));
}
