// Compiles the modules with which the engine of the browser begins, for the interpreter of Pyodide, and adds the tables
// of the grammar, so that it is ready sooner: node distribution/bytecode.mjs studio/build/engine
import { readFileSync, writeFileSync } from "node:fs";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";

const folder = resolve(process.argv[2]);
const { loadPyodide } = await import(pathToFileURL(`${folder}/pyodide.js`).href);
const python = await loadPyodide();
const bytes = readFileSync(`${folder}/cspdiag.zip`);
python.unpackArchive(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength), "zip", { extractDir: "/cspdiag" });
python.runPython(`
import os, pathlib, py_compile, sys, zipfile
os.environ["XDG_CACHE_HOME"] = "/cspdiag/.cache"
sys.path.insert(0, "/cspdiag")
sys.dont_write_bytecode = True
from cspdiag.studio.engine.engine import Engine
engine = Engine(print, kind="browser")
program = engine.request({"id": 1, "method": "hello"})["result"]["models"][0]
for method in ("check", "start"):
    engine.request({"id": 1, "method": method, "params": program})
import cspdiag.draw.communication.diagram, cspdiag.draw.pictures, cspdiag.proofs.portfolio
for module in list(sys.modules.values()):
    file = getattr(module, "__file__", None) or ""
    if file.startswith("/cspdiag/"):
        py_compile.compile(file, invalidation_mode=py_compile.PycInvalidationMode.UNCHECKED_HASH)
with zipfile.ZipFile("/made.zip", "w", zipfile.ZIP_DEFLATED, compresslevel=9) as made:
    for path in sorted(pathlib.Path("/cspdiag").rglob("*")):
        if path.is_file():
            info = zipfile.ZipInfo(str(path.relative_to("/cspdiag")), (2020, 1, 1, 0, 0, 0))
            info.compress_type = zipfile.ZIP_DEFLATED
            made.writestr(info, path.read_bytes())
`);
writeFileSync(`${folder}/cspdiag.zip`, python.FS.readFile("/made.zip"));
