/** The modes that a part of the program goes through. Those that it is in at the same time are in lanes beside each other. */

import type { Mode } from "../engine/messages";

/** Of more spans in a lane the older half is forgotten. */
const MOST = 50_000;
/** A picture of a lane has this number of columns: what is narrower than one is not drawn by itself. */
const COLUMNS = 400;

/** A stretch of time in which a process was in a mode; the end of one that goes on is infinite. */
export interface Span {
  from: number;
  to: number;
  mode: string;
  path: string;
}

export class Lanes {
  readonly lanes: Span[][] = [];
  private readonly open = new Map<string, Span>();
  /** Where each process was last. */
  private readonly places = new Map<string, number>();

  add({ t, path, mode }: Mode): void {
    if (mode === null) {
      this.end(t, path);
    } else if (!this.open.has(path)) {
      this.begin(t, path, mode);
    }
  }

  private begin(t: number, path: string, mode: string): void {
    const lane = this.free(path, t);
    const spans = (this.lanes[lane] ??= []);
    const last = spans.at(-1);
    let span = { from: t, to: Infinity, mode, path };
    if (last?.path === path && last.to === t) {
      // It begins again at the instant of its end, as in a loop.
      span = last;
      span.to = Infinity;
    } else {
      spans.push(span);
    }
    if (spans.length > MOST) {
      spans.splice(0, MOST / 2);
    }
    this.open.set(path, span);
    this.places.set(path, lane);
  }

  /** The lane in which the process was before, or else the first one in which none is. */
  private free(path: string, t: number): number {
    const isFree = (lane: number) => (this.lanes[lane]?.at(-1)?.to ?? -1) <= t;
    const before = this.places.get(path);
    if (before !== undefined && isFree(before)) {
      return before;
    }
    const found = this.lanes.findIndex((_, lane) => isFree(lane));
    return found >= 0 ? found : this.lanes.length;
  }

  private end(t: number, path: string): void {
    const span = this.open.get(path);
    const lane = this.places.get(path) ?? 0;
    if (span === undefined) {
      return;
    }
    span.to = t;
    this.open.delete(path);
    // A process that has begun at this very instant, before this one ended, follows it.
    const next = this.lanes.findIndex((spans, index) => index > lane && spans.length === 1 && spans[0]?.from === t);
    const [following] = this.lanes[next] ?? [];
    if (following !== undefined) {
      this.lanes.splice(next, 1);
      this.lanes[lane]?.push(following);
      for (const [other, place] of this.places) {
        this.places.set(other, place === next ? lane : place > next ? place - 1 : place);
      }
    }
  }

  /** The mode in a lane at an instant. */
  at(lane: number, time: number): string | undefined {
    const spans = this.lanes[lane] ?? [];
    let index = spans.length - 1;
    while (index >= 0 && (spans[index]?.from ?? 0) > time) {
      index -= 1;
    }
    const span = spans[index];
    return span !== undefined && time < span.to ? span.mode : undefined;
  }


  /** What can be seen of a lane from one instant to another, with ends that are finite. */
  spans(lane: number, from: number, to: number, now: number): Span[] {
    const found: Span[] = [];
    const width = (to - from) / COLUMNS;
    for (const span of this.lanes[lane] ?? []) {
      if (span.to < from || span.from > to) {
        continue;
      }
      const shown = { ...span, from: Math.max(span.from, from), to: Math.min(span.to, to, now) };
      const before = found.at(-1);
      if (before?.mode === shown.mode && shown.from - before.to < width) {
        before.to = shown.to;
      } else if (before === undefined || shown.to - before.to >= width) {
        found.push(shown);
      }
    }
    return found;
  }
}
