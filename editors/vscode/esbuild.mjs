// Bundles the extension and its page, or, with --tests, the unit tests; a bundle is one file without dependencies.
import { copyFileSync, mkdirSync, readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { build } from "esbuild";

const production = process.argv.includes("--production");
const shared = { bundle: true, minify: production, sourcemap: !production, logLevel: "warning", metafile: true };
const node = { ...shared, platform: "node", target: "node20", format: "cjs" };

/** The licences of the packages in a bundle, which have to be passed on with it. */
function licences(metafile) {
  const folders = new Set(Object.keys(metafile.inputs).map((file) => /.*node_modules\/(?:@[^/]+\/)?[^/]+/.exec(file)?.[0]));
  folders.delete(undefined);
  return [...folders].sort().map((folder) => {
    const file = readdirSync(folder).find((name) => /^licen[cs]e/i.test(name));
    const { name, version } = JSON.parse(readFileSync(`${folder}/package.json`, "utf8"));
    return `${name} ${version}\n\n${file === undefined ? "" : readFileSync(`${folder}/${file}`, "utf8").trim()}\n`;
  });
}

if (process.argv.includes("--tests")) {
  const tests = readdirSync("test/unit").filter((name) => name.endsWith(".test.ts"));
  await build({ ...node, entryPoints: tests.map((name) => `test/unit/${name}`), outdir: "build/tests" });
} else {
  rmSync("dist", { recursive: true, force: true });
  mkdirSync("build", { recursive: true });
  const { metafile } = await build({ ...node, entryPoints: ["src/extension.ts"], outdir: "dist", external: ["vscode"] });
  await build({ ...shared, entryPoints: ["src/webview/page.ts", "src/webview/page.css"], outdir: "dist", format: "iife" });
  writeFileSync("dist/LICENCES.txt", licences(metafile).join("\n"));
  copyFileSync("../../LICENSE", "LICENSE");
}
