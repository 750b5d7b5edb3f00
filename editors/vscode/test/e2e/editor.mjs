// Starts code-server with the packed extension, and a browser that shows it.
import { execFileSync, spawn } from "node:child_process";
import { cpSync, existsSync, mkdirSync, mkdtempSync, readFileSync, readdirSync, rmSync, symlinkSync, writeFileSync } from "node:fs";
import { createServer } from "node:net";
import { tmpdir } from "node:os";
import path from "node:path";
import { chromium } from "playwright-core";

const HERE = import.meta.dirname;
const CODE_SERVER = path.join(HERE, "node_modules/code-server/out/node/entry.js");
const VSIX = path.join(HERE, "../../build/cspdiag.vsix");

/** How the tests are called: the pytest test sets these. */
const CSPDIAG = process.env.CSPDIAG ?? path.join(HERE, "../../../../.venv/bin/cspdiag");
const CHROMIUM = process.env.CHROMIUM ?? "/usr/bin/chromium";

const SETTINGS = {
  "chat.commandCenter.enabled": false,
  "editor.minimap.enabled": false,
  "extensions.ignoreRecommendations": true,
  "telemetry.telemetryLevel": "off",
  "window.commandCenter": false,
  "workbench.layoutControl.enabled": false,
  "workbench.startupEditor": "none",
  "workbench.tips.enabled": false,
};

async function freePort() {
  const server = createServer();
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  const { port } = server.address();
  await new Promise((resolve) => server.close(resolve));
  return port;
}

/** An editor with a folder open; everything that it writes is in a folder that `close` deletes. */
export class Editor {
  /** `files` are the files of the folder, by name; a value that is not a text is the path of a file to copy. */
  static async start({ files, folder = "project", withCspdiag = true, trusted = true, settings = {} }) {
    const editor = new Editor();
    editor.root = mkdtempSync(path.join(tmpdir(), "cspdiag-vscode-"));
    editor.folder = path.join(editor.root, folder);
    const user = path.join(editor.root, "user");
    mkdirSync(path.join(user, "User"), { recursive: true });
    const trust = { "security.workspace.trust.enabled": !trusted, "security.workspace.trust.startupPrompt": "never" };
    writeFileSync(path.join(user, "User/settings.json"), JSON.stringify({ ...SETTINGS, ...trust, ...settings }));
    mkdirSync(editor.folder, { recursive: true });
    for (const [name, content] of Object.entries(files)) {
      const place = path.join(editor.folder, name);
      mkdirSync(path.dirname(place), { recursive: true });
      if (typeof content === "string" || Buffer.isBuffer(content)) {
        writeFileSync(place, content);
      } else {
        cpSync(content.copy, place);
      }
    }
    if (withCspdiag) editor.install(".venv");
    const places = ["--user-data-dir", user, "--extensions-dir", path.join(editor.root, "extensions")];
    // Without the cspdiag of whoever runs the tests, and without packages of the network.
    const env = { ...process.env, HOME: editor.root, PATH: "/usr/bin:/bin", XDG_CONFIG_HOME: editor.root, PIP_NO_INDEX: "1" };
    delete env.VSCODE_IPC_HOOK_CLI;
    execFileSync(process.execPath, [CODE_SERVER, ...places, "--install-extension", VSIX], { env, stdio: "pipe" });
    const port = await freePort();
    const flags = ["--auth", "none", "--disable-telemetry", "--disable-update-check"];
    if (trusted) flags.push("--disable-workspace-trust");
    editor.server = spawn(
      process.execPath,
      [CODE_SERVER, ...places, ...flags, "--bind-addr", `127.0.0.1:${port}`],
      { env, stdio: ["ignore", "pipe", "pipe"], detached: true },
    );
    await new Promise((resolve, reject) => {
      let said = "";
      const listen = (data) => {
        said += data;
        if (said.includes("HTTP server listening")) resolve();
      };
      editor.server.stdout.on("data", listen);
      editor.server.stderr.on("data", listen);
      editor.server.on("exit", () => reject(new Error(`code-server ended: ${said}`)));
    });
    editor.browser = await chromium.launch({ executablePath: CHROMIUM, args: ["--no-sandbox"] });
    editor.page = await editor.browser.newPage({ viewport: { width: 1280, height: 800 } });
    editor.page.setDefaultTimeout(30_000);
    editor.address = `http://127.0.0.1:${port}/`;
    await editor.page.goto(`${editor.address}?folder=${encodeURIComponent(editor.folder)}`);
    await editor.page.locator(".monaco-workbench").waitFor();
    return editor;
  }

  /** Opens several folders in place of the one. */
  async openWorkspace(folders) {
    const workspace = path.join(this.root, "several.code-workspace");
    writeFileSync(workspace, JSON.stringify({ folders: folders.map((folder) => ({ path: folder })) }));
    await this.page.goto(`${this.address}?workspace=${encodeURIComponent(workspace)}`);
    await this.page.locator(".monaco-workbench").waitFor();
  }

  /** Puts cspdiag into an environment of the folder. */
  install(environment) {
    const bin = path.join(this.folder, environment, "bin");
    mkdirSync(bin, { recursive: true });
    symlinkSync(CSPDIAG, path.join(bin, "cspdiag"));
  }

  /** Removes an environment of the folder. */
  uninstall(environment) {
    rmSync(path.join(this.folder, environment), { recursive: true });
  }

  /** Writes a program of the folder. */
  program(name, text) {
    writeFileSync(path.join(this.folder, name), text, { mode: 0o755 });
  }

  /** Writes the settings of the folder. */
  settings(settings) {
    mkdirSync(path.join(this.folder, ".vscode"), { recursive: true });
    writeFileSync(path.join(this.folder, ".vscode/settings.json"), JSON.stringify(settings));
  }

  /** Changes the colours. */
  async theme(name) {
    await this.page.keyboard.press("Control+k");
    await this.page.keyboard.press("Control+t");
    const input = this.page.locator(".quick-input-widget input");
    await this.page.locator(".quick-input-list .monaco-list-row", { hasText: "Dark Modern" }).first().waitFor();
    await input.fill(name);
    await this.page.locator(".quick-input-list .monaco-list-row.focused", { hasText: name }).waitFor();
    await this.page.keyboard.press("Enter");
    await this.page.locator(".quick-input-widget").waitFor({ state: "hidden" });
  }

  /** Writes into the quick input, and takes the entry with a text. */
  async quickly(written, entry) {
    await this.page.keyboard.press("F1");
    const input = this.page.locator(".quick-input-widget input");
    await input.waitFor();
    await input.fill(written);
    await this.page.locator(".quick-input-list .monaco-list-row", { hasText: entry }).first().waitFor();
    await this.page.keyboard.press("Enter");
  }

  /** Waits until the cursor is in a line of the text. */
  async cursorIn(line) {
    await this.page.locator(".statusbar-item", { hasText: `Ln ${line},` }).waitFor();
  }

  /** Runs a command by its title. */
  async command(title) {
    await this.quickly(`>${title}`, title);
    await this.page.locator(".quick-input-widget").waitFor({ state: "hidden" });
  }

  /** Opens a file of the folder, or by its whole path, at a line and column if they are given. */
  async open(name, line, column = 1) {
    // Not into the group of the diagram.
    await this.page.keyboard.press("Control+1");
    // The whole path: names alone are looked for with ripgrep, which may not be there.
    const file = path.basename(name);
    await this.quickly(path.resolve(this.folder, name), file);
    await this.page.locator(".tab.active", { hasText: file }).waitFor();
    if (line !== undefined) await this.goTo(line, column);
  }

  /** Puts the cursor of the active editor into a line. */
  async goTo(line, column = 1) {
    await this.page.keyboard.press("Control+1");
    await this.page.keyboard.press("Control+g");
    const input = this.page.locator(".quick-input-widget input");
    await input.waitFor();
    await input.fill(`:${line}:${column}`);
    await this.page.locator(".quick-input-list .monaco-list-row.focused", { hasText: `line ${line}` }).waitFor();
    await this.page.keyboard.press("Enter");
    await this.page.locator(".quick-input-widget").waitFor({ state: "hidden" });
  }

  /** Waits for a notification with a text. */
  async notification(text) {
    const found = this.page.locator(".notification-toast .notification-list-item", { hasText: text }).first();
    await found.waitFor();
    return found;
  }

  /** The page of the diagram. */
  get diagram() {
    return this.page.frameLocator('iframe.webview.ready[src*="extensionId=cspdiag.cspdiag"]').frameLocator("#active-frame");
  }

  /** Waits until something is so. */
  async until(holds) {
    for (let tries = 0; !(await holds()); tries++) {
      if (tries > 300) throw new Error(`never so: ${holds}`);
      await new Promise((resolve) => setTimeout(resolve, 100));
    }
  }

  /** The processes of the language server of this editor. */
  servers() {
    return this.processes("lsp");
  }

  /** The processes that run programs for this editor. */
  runs() {
    return this.processes("run");
  }

  processes(verb) {
    const lines = execFileSync("ps", ["-eo", "pid,args"], { encoding: "utf8" }).split("\n");
    return lines.filter((line) => line.includes(`${this.folder}/`) && line.includes(`/bin/cspdiag ${verb}`)).map((line) => parseInt(line));
  }

  /** All processes of this editor: its server, what that has started, and the terminals, which have sessions of their own. */
  started() {
    if (!existsSync("/proc")) return [];
    return readdirSync("/proc")
      .filter((name) => /^[0-9]+$/.test(name))
      .map(Number)
      .filter((pid) => {
        try {
          return readFileSync(`/proc/${pid}/environ`, "latin1").split("\0").includes(`HOME=${this.root}`);
        } catch {
          // It has ended, or is another user's.
          return false;
        }
      });
  }

  /** The processes that draw for this editor. */
  drawers() {
    const servers = this.servers();
    const lines = execFileSync("ps", ["-eo", "pid,ppid,args"], { encoding: "utf8" }).split("\n");
    const found = lines.filter((line) => line.includes("lsp.pictures.drawn")).map((line) => line.trim().split(/\s+/).map(Number));
    return found.filter(([, parent]) => servers.includes(parent)).map(([pid]) => pid);
  }

  async screenshot(name) {
    if (process.env.SCREENSHOTS === undefined) return;
    mkdirSync(process.env.SCREENSHOTS, { recursive: true });
    await this.page.screenshot({ path: path.join(process.env.SCREENSHOTS, `${name}.png`) });
  }

  async close() {
    await this.browser?.close();
    try {
      process.kill(-this.server.pid);
    } catch {
      // It has ended already.
    }
    // Until they have gone, the server and what it has started write into the folder: logs, states, environments.
    for (const [signal, seconds] of [["SIGTERM", 5], ["SIGKILL", 5]]) {
      const end = Date.now() + 1000 * seconds;
      for (let left = this.started(); left.length > 0 && Date.now() < end; left = this.started()) {
        for (const pid of left) {
          try {
            process.kill(pid, signal);
          } catch {
            // It has ended already.
          }
        }
        await new Promise((resolve) => setTimeout(resolve, 100));
      }
    }
    rmSync(this.root, { recursive: true, force: true, maxRetries: 10, retryDelay: 100 });
  }
}
