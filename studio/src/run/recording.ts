/** What a run has done so far, so that one can go back to any instant of it. */

import type { Communication, Frame, Signal, Waiting } from "../engine/messages";
import { Lanes } from "./lanes";
import { Track, lastAt, literals } from "./track";

/** Events are forgotten, the oldest half of them, beyond this number. */
const MOST = 100_000;

interface Dated<T> {
  t: number;
  what: T;
}

/** Things that happen, in their order. */
export class Log<T> {
  readonly times: number[] = [];
  readonly items: T[] = [];

  add(t: number, item: T): void {
    this.times.push(t);
    this.items.push(item);
    if (this.times.length > MOST) {
      this.times.splice(0, MOST / 2);
      this.items.splice(0, MOST / 2);
    }
  }

  /** The last at or before an instant. */
  at(time: number): T | undefined {
    return this.items[lastAt(this.times, this.times.length, time)];
  }

  /** All from one instant to another, both included. */
  between(from: number, to: number): Dated<T>[] {
    const found: Dated<T>[] = [];
    for (let i = lastAt(this.times, this.times.length, to); i >= 0 && (this.times[i] ?? 0) >= from; i--) {
      found.push({ t: this.times[i] ?? 0, what: this.items[i] as T });
    }
    return found.reverse();
  }
}

/** Of processes by their paths those that contain no other one. */
export function innermost(paths: readonly string[]): string[] {
  return paths.filter((path) => !paths.some((other) => other.startsWith(`${path}.`)));
}

export class Recording {
  readonly tracks = new Map<string, Track>();
  readonly communications = new Log<Communication>();
  private readonly running = new Log<readonly string[]>();
  private readonly waiting = new Log<readonly Waiting[]>();
  /** The modes of each part of the program. */
  readonly modes = new Map<string, Lanes>();
  /** The latest instant. */
  now = 0;
  /** How many communications were not reported. */
  omitted = 0;

  constructor(signals: readonly Pick<Signal, "name" | "type" | "literals">[]) {
    for (const signal of signals) {
      this.tracks.set(signal.name, new Track(literals(signal)));
    }
  }

  add(frame: Frame): void {
    for (const [name, { t, v }] of Object.entries(frame.signals)) {
      this.track(name).push(t, v);
    }
    for (const each of frame.communications ?? []) {
      this.communications.add(each.t, each);
    }
    this.omitted += frame.omitted ?? 0;
    for (const mode of frame.modes ?? []) {
      const lanes = this.modes.get(mode.group) ?? new Lanes();
      this.modes.set(mode.group, lanes);
      lanes.add(mode);
    }
    if (frame.running !== undefined) {
      this.running.add(frame.to, frame.running);
    }
    if (frame.waiting !== undefined) {
      this.waiting.add(frame.to, frame.waiting);
    }
    this.now = Math.max(this.now, frame.to);
  }

  private track(name: string): Track {
    const known = this.tracks.get(name);
    if (known !== undefined) {
      return known;
    }
    const made = new Track();
    this.tracks.set(name, made);
    return made;
  }

  /** The deadlock or end, which comes after the last frame. */
  end(at: number, waiting: readonly Waiting[]): void {
    this.now = Math.max(this.now, at);
    if (waiting.length > 0) {
      this.waiting.add(this.now, waiting);
    }
  }

  runningAt(time: number): string[] {
    return [...(this.running.at(time) ?? [])];
  }

  waitingAt(time: number): readonly Waiting[] {
    return this.waiting.at(time) ?? [];
  }

  /** The instant of the last communication before one; that of the first record if there is none. */
  before(time: number): number {
    return this.communications.times[lastAt(this.communications.times, this.communications.times.length, time - 1)] ?? 0;
  }

  /** The instant of the next recorded communication after one. */
  after(time: number): number | undefined {
    const { times } = this.communications;
    return times[lastAt(times, times.length, time) + 1];
  }
}
