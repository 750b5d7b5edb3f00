/** The page: brings its parts together. */

import { Diagram } from "./diagram/diagram";
import { Editor } from "./editor/editor";
import { isProgram } from "./editor/language";
import { Problems } from "./editor/problems";
import { Connection, inWords } from "./engine/engine";
import type { Fix, Hello, Model, Place, Program, Running } from "./engine/messages";
import { chosen } from "./engine/transports";
import { Generate } from "./generate/generate";
import { button, element, options, settled } from "./page/dom";
import { markdown } from "./page/markdown";
import { splitter } from "./page/splitter";
import { theme } from "./page/theme";
import { viewers } from "./page/viewers";
import { tabs } from "./page/views";
import { decoded, encoded } from "./program/link";
import { Saving } from "./program/saving";
import { Trust } from "./program/trust";
import { Workspace } from "./program/workspace";
import { Proofs } from "./proofs/proofs";
import { RunPanel } from "./run/panel";
import { Session } from "./run/session";

/** Milliseconds without a key until the program is checked and drawn, and until the address holds it. */
const PAUSE = 150;
const KEEPING = 500;
/** Names the program of the engine in the list of examples, which has no such name. */
const OWN = "/";
/** What a page says whose server is stopped (Ctrl+Z) or has too little of the processor. */
const SILENT = "The server does not answer: it is stopped, or the machine is too busy.";

const status = element("engine", HTMLElement);
const models = element("models", HTMLSelectElement);
const files = element("files", HTMLElement);
const dialog = element("dialog", HTMLDialogElement);
const message = element("message", HTMLElement);
const layout = element("layout", HTMLElement);

const quiet = settled(4000, () => say(message, ""));
const workspace = new Workspace();
const engine = new Connection(chosen(), {
  lost: (reason) => {
    say(status, `The engine is gone: ${reason}.`, true);
    session.lost();
  },
  silent: (silent) => {
    greet(silent);
    session.silent(silent);
  },
});
const diagram = new Diagram(engine, workspace, go);
const session = new Session(engine);
const trust = new Trust(engine, workspace, look, report);
const run = new RunPanel(session, workspace, diagram, trust);
const proofs = new Proofs(engine, workspace, diagram, trust, go, fix);
const problems = new Problems({ go, fix, explain: (code) => void explain(code) });
const editor = new Editor(element("editor", HTMLElement), {
  changed: (file, text) => workspace.write(file, text),
  cursor: (file, at) => diagram.light(file, at),
  complete: async (file, at) => {
    return engine.request("complete", { ...workspace.sources(), place: { file, ...at } }).catch(() => []);
  },
  hover: async (file, at) => {
    const found = await engine.request("hover", { ...workspace.sources(), place: { file, ...at } }).catch(() => null);
    return found?.markdown;
  },
  definition: async (file, at) => {
    const found = await engine.request("definition", { ...workspace.sources(), place: { file, ...at } }).catch(() => []);
    return found[0];
  },
  go,
  fix,
  format: () => void format(),
});
const generate = new Generate(engine, workspace);
const saving = new Saving(engine, workspace, report, write);
const showHand = viewers(engine, report, (controls) => run.control(controls));
const showPart = tabs(element("parts", HTMLElement), (view) => (layout.dataset["part"] = view));
const showSide = tabs(element("sides", HTMLElement), (view) => (layout.dataset["side"] = view));

/** What the engine is, which `hello` answers. */
let greeting = "Starting the engine …";

/** Says what the engine is, or that it does not answer. */
function greet(silent: boolean): void {
  say(status, silent ? SILENT : greeting, silent);
}

function say(where: HTMLElement, text: string, bad = false): void {
  where.textContent = text;
  where.classList.toggle("bad", bad);
}

/** Shows a message for some seconds. */
function report(text: string): void {
  say(message, text);
  quiet();
}

function go(place: Place): void {
  showFile(place.file);
  showPart("text");
  editor.goTo(place);
}

function showFile(name: string): void {
  const text = workspace.program.files[name];
  if (text === undefined || editor.shown === name) {
    return;
  }
  workspace.shown = name;
  editor.show(name, text);
  paintFiles();
}

function look(file: string): void {
  showFile(file);
  showPart("text");
  editor.focus();
}

/** Replaces the text of a file. */
function write(file: string, text: string): void {
  if (file === editor.shown) {
    editor.replace(text);
  } else {
    workspace.write(file, text);
    paintFiles();
  }
}

/** The files that the last check found to be named as bodies. */
let named = new Set<string>();

/** The files of the program; of a link all, so that nothing of it is out of sight. */
function paintFiles(): void {
  const names = Object.keys(workspace.program.files).filter((name) => workspace.linked || isProgram(name) || named.has(name));
  files.replaceChildren(
    ...names.map((name) => button(name, () => showFile(name), { "aria-pressed": String(name === workspace.shown) })),
  );
}

function fix({ edits }: Fix): void {
  for (const file of new Set(edits.map((edit) => edit.place.file))) {
    showFile(file);
    editor.change(edits.filter((edit) => edit.place.file === file));
  }
  editor.focus();
}

async function explain(code: string): Promise<void> {
  try {
    const { title, markdown: text } = await engine.request("explain", { code });
    element("dialog-body", HTMLElement).replaceChildren(markdown(`# ${code}: ${title}\n\n${text}`));
    dialog.showModal();
  } catch (problem) {
    report(inWords(problem));
  }
}

async function format(): Promise<void> {
  if (!isProgram(editor.shown)) {
    report(`${editor.shown} is not a program, so it is not formatted.`);
    return;
  }
  const before = editor.text;
  try {
    const { text } = await engine.request("format", { text: before });
    if (editor.text === before) {
      editor.replace(text);
    }
  } catch (problem) {
    report(inWords(problem));
  }
}

let checking = false;
/** The version of the program whose check is under way or done. */
let checked = -1;

async function check(): Promise<void> {
  if (checking || checked === workspace.version) {
    return;
  }
  checking = true;
  checked = workspace.version;
  generate.reset();
  diagram.draw();
  try {
    const result = await engine.request("check", workspace.sources());
    problems.show(result.diagnostics);
    if (checked === workspace.version) {
      editor.mark(result.diagnostics);
    }
    named = new Set(result.bodies.flatMap((body) => body.files));
    paintFiles();
    run.checked(result);
    proofs.show(result.assertions);
  } catch (problem) {
    // What was found before is of another program.
    problems.show([{ severity: "error", code: null, message: inWords(problem), place: null, related: [], fixes: [] }]);
    editor.mark([]);
  }
  checking = false;
  await check();
}

const checkSoon = settled(PAUSE, () => void check());

/** Where a program comes from: its name in the list of examples, or a link. */
interface Origin {
  name?: string;
  linked?: boolean;
}

async function load(program: Program, { name = "", linked = false }: Origin): Promise<void> {
  models.value = name;
  saving.opens(name === OWN);
  named.clear();
  trust.opens(linked);
  workspace.open(program, linked);
  say(message, "");
  editor.clear();
  editor.show(program.main, program.files[program.main] ?? "");
  paintFiles();
  diagram.reset();
  await run.opened(name === OWN);
}

async function open(program: Program, origin: Origin): Promise<void> {
  await load(program, origin);
  await check();
}

/** The address holds what is written, so it is still there when the page is loaded again; not files of the machine, which are saved. */
async function keep(): Promise<void> {
  if (workspace.edited && !saving.shown) {
    const address = await encoded(workspace.program);
    try {
      history.replaceState(null, "", address);
    } catch {
      // Longer than an address may be.
    }
  }
}

const keepSoon = settled(KEEPING, () => void keep());

async function share(): Promise<void> {
  history.replaceState(null, "", await encoded(workspace.program));
  try {
    await navigator.clipboard.writeText(location.href);
    report("The link is copied; it holds the whole program.");
  } catch {
    report("The address of this page now holds the whole program.");
  }
}

/** Offers the examples, and the program of the engine, with what was written into it. */
function offer(known: readonly Model[]): void {
  const file = saving.own === undefined ? [] : [[OWN, saving.own.main] as const];
  options(models, [["", "Examples"], ...file, ...known.map((model) => [model.name, model.title] as const)]);
  models.addEventListener("change", () => {
    const name = models.value;
    const model = name === OWN ? saving.own : known.find((each) => each.name === name);
    if (model !== undefined) {
      // The way back leads to what was written before.
      void keep().then(() => {
        history.pushState(null, "", location.pathname + location.search);
        return open(model, { name });
      });
    }
  });
}

/** Shows a program that another page runs. */
async function follow(running: Running): Promise<void> {
  await load({ files: running.files, main: running.main }, running.own === true ? { name: OWN } : {});
  // Before anything is requested: the frames of the run arrive already.
  await run.follow(running);
  await check();
}

async function opened({ models: known, program, running }: Hello): Promise<void> {
  if (running != null) {
    await follow(running);
    return;
  }
  let linked: Program | undefined;
  let problem = "";
  try {
    linked = await decoded(location.hash);
  } catch (damaged) {
    problem = inWords(damaged);
  }
  const example = known.find((model) => model.name === "jiwy") ?? known[0];
  if (linked !== undefined) {
    await open(linked, { linked: true });
  } else if (program != null) {
    await open(program, { name: OWN });
  } else if (example !== undefined) {
    await open(example, { name: example.name });
  }
  say(message, problem);
}

function listen(): void {
  workspace.onChange(checkSoon);
  workspace.onChange(keepSoon);
  engine.on("started", (running) => void follow(running));
  engine.on("on_disk", (program) => saving.take(program));
  engine.on("starting", ({ doing }) => say(status, `Starting the engine: ${doing} …`));
  engine.on("ready", () => greet(false));
  element("share", HTMLButtonElement).addEventListener("click", () => void share());
  element("format", HTMLButtonElement).addEventListener("click", () => void format());
  element("dialog-close", HTMLButtonElement).addEventListener("click", () => dialog.close());
  window.addEventListener("hashchange", () => {
    void decoded(location.hash).then((program) => (program === undefined ? undefined : open(program, { linked: true })), (problem: unknown) => say(message, inWords(problem)));
  });
  window.addEventListener("keydown", (event) => {
    const acts: Record<string, () => void> = {
      F5: () => void run.toggle(),
      F10: () => void run.forward(),
      F9: () => void session.back(),
    };
    const act = event.ctrlKey || event.altKey || event.metaKey ? undefined : acts[event.key];
    if (act !== undefined) {
      event.preventDefault();
      act();
    }
  });
  splitter(element("splitter", HTMLElement), layout);
  theme(() => run.repaint());
  showPart("text");
  showSide("run");
}

async function begin(): Promise<void> {
  listen();
  greet(false);
  try {
    const hello = await engine.request("hello", {});
    trust.onMachine = hello.engine === "machine";
    greeting = hello.engine === "machine" ? `On this machine · ${hello.version}` : `In this browser · ${hello.version}`;
    greet(false);
    if (hello.program != null && hello.able?.["save"] === true) {
      saving.offer(hello.program);
    }
    offer(hello.models);
    generate.offer(hello.targets ?? []);
    run.able(hello.able ?? {}, hello.unable ?? {}, hello.recordings ?? []);
    if (hello.hand !== undefined) {
      showHand({ hand: hello.hand, page: hello.page ?? 1, held_by: hello.held_by ?? null, viewers: hello.viewers ?? 1 });
    }
    await opened(hello);
  } catch (problem) {
    say(status, `The engine did not start: ${inWords(problem)}.`, true);
  }
}

void begin();
