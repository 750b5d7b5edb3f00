/** The time line: what mode each process was in, and a cursor at the instant that is shown. */

import { h } from "../page/dom";
import type { Recording } from "./recording";

const SHADES = 6;
const MOST_SPANS = 400;

export class Modes {
  private readonly rows = new Map<string, { track: HTMLElement; now: HTMLElement }>();
  private readonly shades = new Map<string, number>();

  constructor(private readonly room: HTMLElement) {}

  clear(): void {
    this.rows.clear();
    this.shades.clear();
    this.room.replaceChildren();
    this.room.hidden = true;
  }

  show(recording: Recording, from: number, to: number, at: number): void {
    for (const [path, log] of recording.modes) {
      // A part that is one process has no modes.
      if (log.items.every(({ mode }) => mode === undefined || mode === path)) {
        continue;
      }
      const { track, now } = this.rows.get(path) ?? this.row(path);
      const percent = (time: number) => ((time - from) / Math.max(to - from, 1)) * 100;
      const spans = recording.spans(path, from, to).slice(-MOST_SPANS);
      track.replaceChildren(
        ...spans.map((span) => {
          const part = h("i", { class: `mode shade-${this.shade(span.mode)}`, title: span.mode }, span.mode);
          part.style.left = `${percent(span.from)}%`;
          part.style.width = `${Math.max(percent(span.to) - percent(span.from), 0)}%`;
          return part;
        }),
      );
      const cursor = h("i", { class: "cursor" });
      cursor.style.left = `${Math.min(percent(at), 100)}%`;
      track.append(cursor);
      now.textContent = recording.modeAt(path, at) ?? "–";
    }
  }

  private row(path: string): { track: HTMLElement; now: HTMLElement } {
    const made = { track: h("div", { class: "track", "aria-hidden": "true" }), now: h("output", {}) };
    this.room.append(h("div", { class: "row" }, h("span", {}, path), made.now, made.track));
    this.room.hidden = false;
    this.rows.set(path, made);
    return made;
  }

  private shade(mode: string): number {
    const known = this.shades.get(mode) ?? (this.shades.size % SHADES) + 1;
    this.shades.set(mode, known);
    return known;
  }
}
