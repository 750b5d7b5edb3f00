/** The part of the page that runs the program: its buttons, its pictures, its past. */

import { type Diagram, NOTHING } from "../diagram/diagram";
import type { CheckResult, EnvironmentInfo, ParameterInfo, StartResult } from "../engine/messages";
import { button, element, options } from "../page/dom";
import type { Trust } from "../program/trust";
import type { Workspace } from "../program/workspace";
import { Hand } from "./hand";
import { Modes } from "./modes";
import { Parameters } from "./parameters";
import { Plant, pictureOf } from "./plant";
import { Plots } from "./plots";
import { innermost } from "./recording";
import type { Session } from "./session";
import { clock } from "./track";
import { text } from "./value";
import * as waits from "./waits";

/** How long a stretch of time the plots show while the run goes on, in nanoseconds. */
const WINDOW = 10e9;
/** A communication is marked for this long after it, in nanoseconds of the program. */
const FLASH = 100e6;
const MOST_SHOWN = 8;
const REAL_TIME = "real time";
const CODE = "What runs: both do the same, C faster, after the C compiler has worked";
const WATCHES = "Another page controls the program: take control first";
/** What the button says that begins, pauses and resumes a run. */
const LABELS = { idle: "Run", starting: "Starting", playing: "Pause", paused: "Resume", ended: "Again" } as const;
const PACED = "In real time a program can be stopped, not paused";
const STALLED = {
  server: "The run stands still on this page, because the server does not answer.",
  process:
    "Nothing has arrived of the run for 3 s: one of its processes computes without a communication, or the engine has other work. Stop ends the run.",
};

export class RunPanel {
  private readonly environment = element("environment", HTMLSelectElement);
  private readonly inputs = element("inputs", HTMLSelectElement);
  private readonly code = element("code", HTMLSelectElement);
  private readonly speed = element("speed", HTMLSelectElement);
  private readonly run = element("run-button", HTMLButtonElement);
  private readonly step = element("step", HTMLButtonElement);
  private readonly back = element("back", HTMLButtonElement);
  private readonly stop = element("stop", HTMLButtonElement);
  private readonly scrub = element("scrub", HTMLInputElement);
  private readonly time = element("time", HTMLOutputElement);
  private readonly note = element("run-note", HTMLElement);
  private readonly events = element("events", HTMLElement);
  private readonly empty = element("run-empty", HTMLElement);
  private readonly plantRoom = element("plant", HTMLElement);
  private readonly plots: Plots;
  private readonly modes = new Modes(element("modes", HTMLElement));
  private readonly plant: Plant;
  private readonly hand: Hand;
  private readonly parameters: Parameters;
  private known: ParameterInfo[] = [];
  private environments: EnvironmentInfo[] = [];
  private recordings: readonly string[] = [];
  private ranVersion = -1;
  /** Whether the program is that of the engine. */
  private own = false;
  /** Whether this page controls the program. */
  private controls = true;
  private painting = false;
  private begun: unknown;
  /** Whether, and why not, this machine runs C. */
  private runsC = false;
  private aboutC = CODE;

  constructor(
    private readonly session: Session,
    private readonly workspace: Workspace,
    private readonly diagram: Diagram,
    private readonly trust: Trust,
  ) {
    this.plots = new Plots(element("plots", HTMLElement), (at) => void this.look(at), () => this.soon());
    this.plant = new Plant(this.plantRoom);
    this.hand = new Hand(element("hand", HTMLElement), (name, value) => session.input(name, value));
    this.parameters = new Parameters(element("parameters", HTMLElement), (name, value) => session.tune(name, value));
    this.run.addEventListener("click", () => void this.toggle());
    this.step.addEventListener("click", () => void this.forward());
    this.back.addEventListener("click", () => void session.back());
    this.stop.addEventListener("click", () => void session.stop());
    this.speed.addEventListener("change", () => {
      this.soon();
      if (session.phase === "playing" && session.realTime === this.realTime) {
        void session.play(this.chosenSpeed);
      }
    });
    this.environment.addEventListener("change", () => {
      this.offerCode();
      void this.reset();
    });
    this.inputs.addEventListener("change", () => void this.reset());
    this.code.addEventListener("change", () => void this.reset());
    this.scrub.addEventListener("input", () => void this.look(this.scrub.valueAsNumber * 1e6));
    session.onChange(() => this.soon());
    this.soon();
  }

  /** What the engine can do, why not, and the recordings that it has. */
  able(able: Record<string, boolean>, unable: Record<string, string>, recordings: readonly string[]): void {
    this.code.hidden = able["real_time"] !== true; // In a browser there is only Python.
    this.runsC = able["native"] === true;
    this.aboutC = unable["native"] === undefined ? CODE : `Not as C: ${unable["native"]}`;
    this.offerCode();
    element("speed-real", HTMLOptionElement).hidden = able["real_time"] !== true;
    this.recordings = recordings;
    options(this.inputs, [["", "its own inputs"], ...recordings.map((name) => [name, `inputs of ${name}`] as const)]);
  }

  private get realTime(): boolean {
    return this.speed.value === REAL_TIME;
  }

  private get target(): string {
    return this.code.value;
  }

  private get chosenSpeed(): number {
    return this.realTime ? 1 : Number(this.speed.value);
  }

  /** Offers the code that can run here, with the drivers of the chosen environment. */
  private offerCode(): void {
    const drivers = this.environments.find((each) => each.name === this.environment.value)?.drivers ?? [];
    const inC = drivers.find((driver) => driver.language === "c");
    const inPython = drivers.find((driver) => driver.language !== "c");
    const possible = { python: inC === undefined, c: this.runsC && inPython === undefined };
    for (const option of this.code.options) {
      option.disabled = !possible[option.value as "python" | "c"];
    }
    if (possible.python !== possible.c) {
      this.code.value = possible.c ? "c" : "python";
    }
    this.code.title =
      inC !== undefined ? `Not as Python: the driver ${inC.name} is written in C` : this.runsC && inPython !== undefined ? `Not as C: the driver ${inPython.name} is in Python` : this.aboutC;
  }

  /** What the check found of environments and parameters. */
  checked(result: CheckResult): void {
    this.environments = result.environments;
    const names = result.environments.map((each) => [each.name, each.name] as const);
    options(this.environment, names.length === 0 ? [["", "none"]] : names);
    this.offerCode();
    if (JSON.stringify(result.parameters) !== JSON.stringify(this.known)) {
      this.known = result.parameters;
      this.parameters.open(this.known);
    }
    this.preview();
  }

  /** Another program is opened, of which no environment is known until it is checked. Recordings are those of the `own` one. */
  async opened(own: boolean): Promise<void> {
    this.own = own;
    this.inputs.value = "";
    this.inputs.hidden = !own || this.recordings.length === 0;
    this.environment.replaceChildren();
    this.known = [];
    this.parameters.open([]);
    await this.reset();
  }

  /** The run is left, as it is of another program or environment. */
  private async reset(): Promise<void> {
    this.begun = undefined;
    this.modes.clear();
    this.plots.open([], this.session.recording);
    this.hand.open([]);
    await this.session.leave();
    this.preview();
  }

  /** The picture of the plant stands still as long as nothing runs. */
  private preview(): void {
    if (this.session.started === undefined) {
      this.plantRoom.hidden = !this.plant.open(pictureOf(this.workspace.program, this.environment.value), []);
    }
  }

  /** This page controls the program, or only shows it. */
  control(controls: boolean): void {
    this.controls = controls;
    void this.session.control(controls);
    for (const room of [element("hand", HTMLElement), element("parameters", HTMLElement)]) {
      room.inert = !controls;
    }
    for (const choice of [this.environment, this.inputs, this.code, this.speed]) {
      choice.disabled = !controls;
    }
    this.soon();
  }

  /** A run that another page has begun, of the program that is open. */
  async follow(running: StartResult): Promise<void> {
    this.ranVersion = this.workspace.version;
    await this.session.follow(running);
  }

  repaint(): void {
    this.plots.repaint();
    this.soon();
  }

  async toggle(): Promise<void> {
    if (!this.controls) {
      return;
    }
    if (this.session.phase === "playing") {
      await this.session.pause();
    } else if (await this.ready(this.session.phase === "ended")) {
      await this.session.play(this.chosenSpeed);
    }
  }

  async forward(): Promise<void> {
    // Of a run that has ended, what is recorded after the instant that is shown comes next.
    if (!this.controls ? this.session.started !== undefined : await this.ready(this.session.phase === "ended" && this.session.live)) {
      await this.session.step();
    }
  }

  async look(at: number): Promise<void> {
    await this.session.pause();
    this.session.look(at);
  }

  /** Whether a run is there that can continue: of a changed program, and if it is `over`, a new one begins. */
  private async ready(over: boolean): Promise<boolean> {
    const { session } = this;
    const same = this.ranVersion === this.workspace.version && session.realTime === this.realTime && session.target === this.target;
    if (session.started !== undefined && !over && same) {
      return true;
    }
    if (!(await this.trust.mayRun())) {
      return false;
    }
    this.ranVersion = this.workspace.version;
    // With the pictures, which other pages show, too.
    return session.start(this.workspace.program, {
      environment: this.environment.value || undefined,
      inputs: this.inputs.value || undefined,
      set: Object.fromEntries(this.parameters.changed),
      real_time: this.realTime,
      target: this.target,
      own: this.own,
    });
  }

  /** Paints once in each frame of the screen, however much has happened. */
  private soon(): void {
    if (!this.painting) {
      this.painting = true;
      requestAnimationFrame(() => {
        this.painting = false;
        this.paint();
      });
    }
  }

  private paint(): void {
    const { session } = this;
    const { phase, recording, started } = session;
    if (started !== undefined && this.begun !== started) {
      this.begun = started;
      this.modes.clear();
      this.plots.open(started.signals, recording);
      this.hand.open(started.signals);
      const names = started.signals.map((signal) => signal.name);
      this.plantRoom.hidden = !this.plant.open(pictureOf(this.workspace.program, started.environment ?? this.environment.value), names);
    }
    this.run.textContent = this.controls ? LABELS[phase] : "Watching";
    const paced = session.realTime && phase === "playing";
    this.run.disabled = phase === "starting" || paced || !this.controls;
    this.step.disabled = (paced || !this.controls) && session.live;
    const why = !this.controls ? WATCHES : paced ? PACED : undefined;
    this.run.title = why ?? "F5";
    this.step.title = this.step.disabled && why !== undefined ? why : "To the next communication: F10";
    this.stop.title = this.controls ? "" : WATCHES;
    const any = started !== undefined;
    this.back.disabled = !any || session.shown <= 0;
    this.stop.disabled = !any || phase === "ended" || session.stopping || !this.controls;
    this.empty.hidden = any || session.problem !== "";
    this.showTime();
    this.showNote();
    if (!any) {
      this.diagram.mark(NOTHING);
      this.events.replaceChildren();
      return;
    }
    const at = session.shown;
    const to = session.live ? Math.max(recording.now, 1e6) : Math.max(at, Math.min(recording.now, at + WINDOW / 2));
    const from = Math.max(0, to - WINDOW);
    this.plots.show(from, Math.max(to, from + 1e6), at, phase === "playing");
    this.modes.show(recording, from, Math.max(to, from + 1e6), at);
    this.plant.show((name) => recording.tracks.get(name)?.at(at));
    this.markDiagram(at);
    if (phase === "playing") {
      this.hand.poll();
      this.soon();
    }
  }

  private showTime(): void {
    const { session } = this;
    const milliseconds = session.recording.now / 1e6;
    this.scrub.max = String(milliseconds);
    this.scrub.disabled = session.started === undefined;
    this.scrub.value = String(session.shown / 1e6);
    this.scrub.setAttribute("aria-valuetext", clock(session.shown));
    this.time.textContent = session.live ? clock(session.shown) : `${clock(session.shown)} of ${clock(session.recording.now)}`;
  }

  private showNote(): void {
    const { session } = this;
    const { ended, problem, refused } = session;
    const stale = session.started !== undefined && this.ranVersion !== this.workspace.version;
    const missed = Object.entries(session.missed).map(([name, count]) => `${name} (${count})`);
    const { stalled, standsStill, stopping } = session;
    const compiling = session.phase === "starting" && this.target === "c";
    const key = [compiling, problem, refused, ended?.text, ended?.reason, stale, this.controls, missed.join(), standsStill, stalled, stopping].join("|");
    if (this.note.dataset["key"] === key) {
      return;
    }
    this.note.dataset["key"] = key;
    this.note.className = "note";
    this.note.replaceChildren();
    if (problem !== "") {
      this.note.classList.add("bad");
      this.note.append(problem);
    } else if (compiling) {
      this.note.append("The C compiler works. What it has compiled it need not compile again.");
    } else if (ended !== undefined) {
      this.note.classList.toggle("bad", ended.reason === "deadlock" || ended.reason === "fault");
      const listed = ended.waiting != null && ended.waiting.length > 0;
      const text = listed ? (ended.text.split("\n")[0] ?? "") : ended.text;
      this.note.append(text === "" ? `The run has ended: ${ended.reason}.` : text);
      if (listed) {
        this.note.append(waits.list(ended.waiting ?? []));
      }
    } else if (stopping) {
      this.note.append("Stopping …");
    } else if (stalled !== undefined) {
      this.note.classList.add("bad");
      this.note.append(STALLED[stalled]);
    } else if (standsStill) {
      this.note.classList.add("bad");
      const working = innermost(session.recording.runningAt(session.recording.now)).join(", ");
      const who = working === "" ? "" : ` At work: ${working}.`;
      this.note.append(`Simulated time stands still at ${clock(session.recording.now)}: the program communicates or computes without end in this instant.${who} Prove shows a run without end.`);
    } else if (stale) {
      this.note.append("This is a run of the text as it was. ");
      if (this.controls) {
        this.note.append(button("Run the new text", () => void this.again()));
      }
    }
    const late = missed.length > 0 ? `Samples that came too late to be taken: ${missed.join(", ")}.` : "";
    for (const text of [refused, late].filter((each) => each !== "")) {
      this.note.classList.add("bad");
      this.note.append(Object.assign(document.createElement("p"), { textContent: text }));
    }
    this.note.hidden = this.note.childNodes.length === 0;
  }

  private async again(): Promise<void> {
    await this.session.leave();
    await this.toggle();
  }

  private markDiagram(at: number): void {
    const { recording, phase, ended } = this.session;
    const recent = recording.communications.between(Math.max(at - FLASH, 0), at);
    const moves = phase === "playing" && this.session.live;
    const last = moves ? recent : recent.filter((each) => each.t === recent.at(-1)?.t);
    this.diagram.mark({
      running: recording.runningAt(at),
      waiting: moves ? [] : recording.waitingAt(at),
      stuck: ended?.reason === "deadlock" && this.session.live ? (ended.waiting ?? []) : [],
      communicating: [...new Set(last.map((each) => each.what.channel))],
    });
    const shown = recording.communications.between(0, at).slice(-MOST_SHOWN).reverse();
    this.events.replaceChildren(
      ...shown.map(({ t, what }) => {
        const row = document.createElement("li");
        const parts = [clock(t), what.channel, what.value === undefined ? "" : text(what.value)];
        row.append(...parts.map((part) => Object.assign(document.createElement("span"), { textContent: part })));
        row.title = `${what.writer ?? "the environment"} → ${what.reader ?? "the environment"}`;
        return row;
      }),
    );
  }
}
