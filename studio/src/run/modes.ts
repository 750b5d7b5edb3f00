/** The time line: what mode each part of the program was in, and a cursor at the instant that is shown. */

import { h } from "../page/dom";
import type { Recording } from "./recording";

const SHADES = 6;
/** Modes at the same time that are shown of a part of the program. */
const MOST_LANES = 8;

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
    for (const [group, lanes] of recording.modes) {
      // A part that is one process has no modes.
      if (lanes.lanes.every((spans) => spans.every(({ mode }) => mode === group))) {
        continue;
      }
      const count = lanes.lanes.length;
      for (let lane = 0; lane < Math.min(count, MOST_LANES); lane++) {
        const key = JSON.stringify([group, lane]);
        const { track, now } = this.rows.get(key) ?? this.row(key, group, lane);
        const percent = (time: number) => ((time - from) / Math.max(to - from, 1)) * 100;
        track.replaceChildren(
          ...lanes.spans(lane, from, to, recording.now).map((span) => {
            const part = h("i", { class: `mode shade-${this.shade(span.mode)}`, title: span.mode }, span.mode);
            part.style.left = `${percent(span.from)}%`;
            part.style.width = `${Math.max(percent(span.to) - percent(span.from), 0)}%`;
            return part;
          }),
        );
        const cursor = h("i", { class: "cursor" });
        cursor.style.left = `${Math.min(percent(at), 100)}%`;
        track.append(cursor);
        const more = lane === MOST_LANES - 1 && count > MOST_LANES ? ` (and ${count - MOST_LANES} more at the same time)` : "";
        now.textContent = `${lanes.at(lane, at) ?? "–"}${more}`;
      }
    }
  }

  private row(key: string, group: string, lane: number): { track: HTMLElement; now: HTMLElement } {
    const made = { track: h("div", { class: "track", "aria-hidden": "true" }), now: h("output", { "aria-label": group }) };
    const row = h("div", { class: "row" }, h("span", { "aria-hidden": lane > 0 ? "true" : undefined }, lane > 0 ? "" : group), made.now, made.track);
    // The lanes of a part are together, also if one comes late.
    const before = this.rows.get(JSON.stringify([group, lane - 1]))?.track.parentElement;
    if (before == null) {
      this.room.append(row);
    } else {
      before.after(row);
    }
    this.room.hidden = false;
    this.rows.set(key, made);
    return made;
  }

  private shade(mode: string): number {
    const known = this.shades.get(mode) ?? (this.shades.size % SHADES) + 1;
    this.shades.set(mode, known);
    return known;
  }
}
