/** The values of a signal over time, as they were recorded, and what of them can be seen. */

import type { Value } from "../engine/messages";

const BLOCK = 32;
const MOST = 1_000_000;

/** Index of the last time at or before an instant; -1 before the first. */
export function lastAt(times: ArrayLike<number>, length: number, at: number): number {
  let [low, high] = [0, length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if ((times[middle] ?? 0) <= at) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low - 1;
}

/** Grows as values come; of more than a million the older half is forgotten. */
export class Track {
  private times = new Float64Array(256);
  private values = new Float64Array(256);
  /** Smallest and largest value of each whole block, so that long runs can be shown at once. */
  private lows: number[] = [];
  private highs: number[] = [];
  length = 0;

  /** `labels` are the names of values that are not numbers, such as those of an enum; the number is the place in this list. */
  constructor(readonly labels: string[] = []) {}

  push(t: readonly number[], v: readonly Value[]): void {
    for (let i = 0; i < t.length; i++) {
      this.add(t[i] ?? 0, this.number(v[i] ?? null));
    }
  }

  private number(value: Value): number {
    if (typeof value === "number") {
      return value;
    }
    if (typeof value === "boolean") {
      return value ? 1 : 0;
    }
    if (value === null) {
      return NaN;
    }
    const known = this.labels.indexOf(value);
    return known >= 0 ? known : this.labels.push(value) - 1;
  }

  private add(t: number, v: number): void {
    if (this.length === this.times.length) {
      this.room();
    }
    this.times[this.length] = t;
    this.values[this.length] = v;
    this.length += 1;
    if (this.length % BLOCK === 0) {
      let [low, high] = [Infinity, -Infinity];
      for (let i = this.length - BLOCK; i < this.length; i++) {
        const value = this.values[i] ?? NaN;
        low = value < low ? value : low;
        high = value > high ? value : high;
      }
      this.lows.push(low);
      this.highs.push(high);
    }
  }

  private room(): void {
    if (this.length < MOST) {
      const [times, values] = [new Float64Array(this.length * 2), new Float64Array(this.length * 2)];
      times.set(this.times);
      values.set(this.values);
      [this.times, this.values] = [times, values];
      return;
    }
    const blocks = Math.floor(this.length / BLOCK / 2);
    this.times.copyWithin(0, blocks * BLOCK);
    this.values.copyWithin(0, blocks * BLOCK);
    this.length -= blocks * BLOCK;
    this.lows = this.lows.slice(blocks);
    this.highs = this.highs.slice(blocks);
  }

  /** The value that holds at an instant; undefined before the first. */
  at(time: number): number | undefined {
    const index = lastAt(this.times, this.length, time);
    const value = index < 0 ? NaN : (this.values[index] ?? NaN);
    return Number.isNaN(value) ? undefined : value;
  }

  /** The value at an instant as a text. */
  textAt(time: number): string {
    const value = this.at(time);
    return value === undefined ? "–" : (this.labels[value] ?? short(value));
  }

  get first(): number | undefined {
    return this.length === 0 ? undefined : this.times[0];
  }

  /**
   * Two values for each column of a plot from one instant to another: what holds at its start and the value that
   * differs most from that, so that no peak is lost.
   */
  columns(from: number, to: number, count: number): (number | null)[] {
    const seen: (number | null)[] = [];
    const wide = (to - from) / count;
    let start = lastAt(this.times, this.length, from);
    for (let column = 0; column < count; column++) {
      const end = lastAt(this.times, this.length, from + wide * (column + 1));
      const held = start < 0 ? NaN : (this.values[start] ?? NaN);
      const peak = this.extreme(start + 1, end, held);
      seen.push(Number.isNaN(held) ? null : held, Number.isNaN(peak) ? null : peak);
      start = end;
    }
    return seen;
  }

  /** The value with the indices from the first to the last that differs most from one. */
  private extreme(first: number, last: number, from: number): number {
    let best = from;
    const look = (value: number) => {
      if (Number.isNaN(best) || Math.abs(value - from) > Math.abs(best - from)) {
        best = value;
      }
    };
    for (let i = first; i <= last; ) {
      if (i % BLOCK === 0 && i + BLOCK - 1 <= last) {
        look(this.lows[i / BLOCK] ?? NaN);
        look(this.highs[i / BLOCK] ?? NaN);
        i += BLOCK;
      } else {
        look(this.values[i] ?? NaN);
        i += 1;
      }
    }
    return best;
  }
}

/** The names of the values of a signal, in the order of their numbers; of one that is a number there are none. */
export function literals(signal: { type?: string; literals?: readonly string[] | null }): string[] {
  return signal.type === "bool" ? ["false", "true"] : [...(signal.literals ?? [])];
}

/** A number with as many digits as one reads at a glance. */
export function short(value: number): string {
  if (Number.isInteger(value) && Math.abs(value) < 1e6) {
    return String(value);
  }
  return Math.abs(value) >= 1e5 || (value !== 0 && Math.abs(value) < 1e-3) ? value.toExponential(2) : value.toPrecision(4).replace(/\.?0+$/, "");
}

/** An instant as one reads it. */
export function clock(nanoseconds: number): string {
  return `${(nanoseconds / 1e9).toFixed(3)} s`;
}
