/** A run of the program on the engine, what was recorded of it, and the instant that the page shows. */

import { type Engine, inWords } from "../engine/engine";
import type { Chosen, Ended, Frame, Program, SessionId, StartResult, Value } from "../engine/messages";
import { Recording } from "./recording";

export type Phase = "idle" | "starting" | "playing" | "paused" | "ended";

/** Milliseconds of frames in one instant after which it is said that time stands still. */
const STANDSTILL = 2000;
/** Milliseconds without a frame after which it is said that nothing arrives. */
const PATIENCE = 3000;

export class Session {
  phase: Phase = "idle";
  /** Whether this page controls the run. One that watches may look back, while the run goes on. */
  controls = true;
  started: StartResult | undefined;
  recording = new Recording([]);
  ended: Ended | undefined;
  /** Why a request of this run was refused. Of a run that has ended, how it has ended says that. */
  problem = "";
  /** The last change of a parameter that the program has refused. */
  refused = "";
  /** How many samples of inputs were missed until now. */
  missed: Record<string, number> = {};
  /** Whether the run is asked to stop, which a process that computes without end does not do at once. */
  stopping = false;
  /** Whether frames have arrived for some time in which time has not passed. */
  standsStill = false;
  /** When time passed last, by the clock of the page. */
  private passed = 0;
  /** When the last frame arrived, by the clock of the page; undefined of a run that another page may have paused. */
  private arrived: number | undefined;
  /** Whether the server does not answer. */
  private unanswered = false;
  /** The instant that is shown; undefined: the latest. */
  private looked: number | undefined;
  private listeners: (() => void)[] = [];
  private readonly sent = new Map<string, Value>();
  private sending = false;

  constructor(private readonly engine: Engine) {
    engine.on("frame", (frame) => this.frame(frame));
    engine.on("ended", (ended) => this.end(ended));
  }

  onChange(listener: () => void): void {
    this.listeners.push(listener);
  }

  /** The instant that the page shows. */
  get shown(): number {
    return this.looked ?? this.recording.now;
  }

  /** Whether the run keeps pace with the clock: then it can be stopped, not paused. */
  get realTime(): boolean {
    return this.started?.real_time === true;
  }

  /** The language of the code that runs. */
  get target(): string {
    return this.started?.target ?? "python";
  }

  get live(): boolean {
    return this.looked === undefined;
  }

  /** Why nothing has arrived of a run that goes on: the server does not answer, or a process computes without end. */
  get stalled(): "server" | "process" | undefined {
    if (this.phase !== "playing") {
      return undefined;
    }
    return this.unanswered ? "server" : performance.now() - (this.arrived ?? Infinity) > PATIENCE ? "process" : undefined;
  }

  /** The engine is gone, and what it ran has ended with it. */
  lost(): void {
    if (this.started !== undefined && this.ended === undefined) {
      this.end({ session: this.session, at: null, reason: "fault", text: "The run has ended, as its engine is gone." });
    }
  }

  /** The server does not answer for the time being, or answers again. */
  silent(silent: boolean): void {
    this.unanswered = silent;
    this.hear();
    this.changed();
  }

  /** Begins a run of the program as it is now; it stands at its first instant, unless it keeps pace with the clock. */
  async start(program: Program, chosen: Chosen): Promise<boolean> {
    await this.leave();
    this.phase = "starting";
    this.problem = "";
    this.changed();
    try {
      this.started = await this.engine.request("start", { ...program, ...chosen });
    } catch (problem) {
      this.fail(problem);
      return false;
    }
    this.recording = new Recording(this.started.signals);
    this.phase = "paused";
    this.looked = undefined;
    this.changed();
    return true;
  }

  /** Shows a run that another page has begun. */
  async follow(running: StartResult): Promise<void> {
    this.started = undefined;
    await this.leave();
    this.started = running;
    this.recording = new Recording(running.signals);
    this.phase = "playing";
    this.passed = performance.now();
    this.arrived = undefined;
    this.changed();
  }

  /** Continues; speed 1 is real time, 0 as fast as it goes. */
  async play(speed: number): Promise<void> {
    if (this.started === undefined || this.ended !== undefined) {
      return;
    }
    this.looked = undefined;
    this.phase = "playing";
    this.passed = performance.now();
    this.arrived = this.passed;
    this.changed();
    await this.ask(() => this.engine.request("play", { session: this.session, speed }));
  }

  async pause(): Promise<void> {
    if (this.controls && this.phase === "playing" && !this.realTime) {
      this.phase = "paused";
      this.standsStill = false;
      this.changed();
      await this.ask(() => this.engine.request("pause", { session: this.session }));
    }
  }

  /** To the next communication: in what is recorded if one has gone back, otherwise by the program. */
  async step(): Promise<void> {
    await this.pause();
    const next = this.looked === undefined ? undefined : this.recording.after(this.looked);
    if (next !== undefined) {
      this.look(next);
    } else if (this.controls && this.ended === undefined && this.started !== undefined && !this.realTime) {
      this.looked = undefined;
      await this.ask(() => this.engine.request("step", { session: this.session, by: "communication" }));
    }
  }

  /** To the communication before. */
  async back(): Promise<void> {
    await this.pause();
    this.look(this.recording.before(this.shown));
  }

  /** Shows an instant of what was recorded; the latest is live. */
  look(at: number): void {
    this.looked = at >= this.recording.now ? undefined : Math.max(at, 0);
    this.changed();
  }

  /** This page controls the run, or only shows it. One that begins to control it learns whether the page before has paused it. */
  async control(controls: boolean): Promise<void> {
    const begins = controls && !this.controls;
    const { started, phase } = this;
    this.controls = controls;
    if (!begins || (phase !== "playing" && phase !== "paused")) {
      return;
    }
    const state = await this.engine.request("state", { session: this.session }).catch(() => undefined);
    if (state !== undefined && this.started === started && this.phase === phase) {
      this.phase = state.playing ? "playing" : "paused";
      this.changed();
    }
  }

  /** Ends the run; what was recorded stays. */
  async stop(): Promise<void> {
    const { started } = this;
    if (started !== undefined && this.ended === undefined && !this.stopping) {
      this.stopping = true;
      this.changed();
      await this.ask(() => this.engine.request("stop", { session: started.session }));
      if (this.started === started) {
        this.stopping = false;
        this.phase = "ended";
        this.changed();
      }
    }
  }

  /** Ends the run and forgets it. */
  async leave(): Promise<void> {
    const before = this.started;
    const running = this.controls && before !== undefined && this.ended === undefined && this.phase !== "ended";
    this.started = undefined;
    this.ended = undefined;
    this.phase = "idle";
    this.looked = undefined;
    this.problem = "";
    this.refused = "";
    this.missed = {};
    this.standsStill = false;
    this.stopping = false;
    this.sent.clear();
    this.recording = new Recording([]);
    this.changed();
    if (running) {
      await this.engine.request("stop", { session: before.session }).catch(() => undefined);
    }
  }

  /** Takes an input over, or gives it back to the environment by null; of many values in a frame the last is sent. */
  input(name: string, value: Value): void {
    this.sent.set(name, value);
    if (!this.sending) {
      this.sending = true;
      requestAnimationFrame(() => {
        this.sending = false;
        const values = [...this.sent];
        this.sent.clear();
        if (this.started !== undefined && this.phase !== "ended") {
          for (const [each, to] of values) {
            void this.ask(() => this.engine.request("input", { session: this.session, name: each, value: to }));
          }
        }
      });
    }
  }

  /** Changes a parameter, or a part of one. */
  tune(name: string, value: Value): void {
    if (this.started !== undefined && this.phase !== "ended") {
      void this.ask(() => this.engine.request("tune", { session: this.session, name, value }));
    }
  }

  private hear(): void {
    this.arrived = this.arrived === undefined ? undefined : performance.now();
  }

  private get session(): SessionId {
    return this.started?.session ?? "";
  }

  private async ask(request: () => Promise<unknown>): Promise<void> {
    try {
      await request();
    } catch (problem) {
      if (this.ended === undefined) {
        this.problem = inWords(problem);
        this.changed();
      }
    }
  }

  private fail(problem: unknown): void {
    this.phase = "idle";
    this.problem = inWords(problem);
    this.changed();
  }

  private frame(frame: Frame): void {
    if (frame.session === this.started?.session) {
      if (frame.to > this.recording.now || this.phase !== "playing" || this.realTime) {
        this.passed = performance.now();
      }
      this.hear();
      this.standsStill = performance.now() - this.passed > STANDSTILL;
      this.recording.add(frame);
      this.missed = frame.missed ?? {};
      const refused = frame.refused?.at(-1);
      this.refused = refused === undefined ? this.refused : `${refused.parameter}: ${refused.text}`;
      this.changed();
    }
  }

  private end(ended: Ended): void {
    if (ended.session === this.started?.session) {
      this.ended = ended;
      this.problem = "";
      this.standsStill = false;
      this.phase = "ended";
      this.recording.end(ended.at ?? this.recording.now, ended.waiting ?? []);
      this.changed();
    }
  }

  private changed(): void {
    for (const listener of this.listeners) {
      listener();
    }
  }
}
