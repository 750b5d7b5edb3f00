/** The elements of a diagram by the names that runs and proofs use. */

import { contains, smaller } from "../editor/places";
import type { DrawnElement, Place, Position, Waiting } from "../engine/messages";

export class Elements {
  private readonly byPath = new Map<string, DrawnElement[]>();

  constructor(readonly all: readonly DrawnElement[] = []) {
    for (const each of all) {
      for (const name of [...(each.path == null ? [] : [each.path]), ...(each.channels ?? [])]) {
        this.byPath.set(name, [...(this.byPath.get(name) ?? []), each]);
      }
    }
  }

  /** What represents a process or channel: itself, or the instance around it that is drawn. */
  named(path: string): string[] {
    for (let name = path; name !== ""; name = name.slice(0, Math.max(name.lastIndexOf("."), 0))) {
      const found = this.byPath.get(name) ?? this.byPath.get(name.replace(/\[[^\]]*\]$/, ""));
      if (found !== undefined) {
        return found.map((each) => each.id);
      }
    }
    return [];
  }

  everyNamed(paths: Iterable<string>): Set<string> {
    return new Set([...paths].flatMap((path) => this.named(path)));
  }

  /** The channels that are waited for, and who waits. */
  waiting(waiting: readonly Waiting[]): Set<string> {
    return this.everyNamed(waiting.flatMap((each) => [each.process, ...each.channels]));
  }

  /** The smallest elements around a position of the text. */
  at(file: string, position: Position): string[] {
    let best: string[] = [];
    let smallest: Place | undefined;
    for (const each of this.all) {
      for (const place of each.places ?? []) {
        if (!contains(place, file, position)) {
          continue;
        }
        if (smallest === undefined || smaller(place, smallest)) {
          [best, smallest] = [[each.id], place];
        } else if (!smaller(smallest, place)) {
          best.push(each.id);
        }
      }
    }
    return best;
  }

  /** Elements whose names contain a text. */
  search(text: string): string[] {
    const wanted = text.trim().toLowerCase();
    const fits = (each: DrawnElement) => `${each.path ?? ""} ${each.name} ${each.definition ?? ""}`.toLowerCase().includes(wanted);
    return wanted === "" ? [] : this.all.filter(fits).map((each) => each.id);
  }
}
