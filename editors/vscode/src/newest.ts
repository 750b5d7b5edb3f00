/** Of several that do the same, only the newest counts. Nothing here knows VS Code, so that it can be tested alone. */

/** Knows what is under way; what is begun later under the same key takes the place of the one before. */
export class Newest {
  private readonly underWay = new Map<string, AbortController>();

  /** Begins something; the signal is aborted when something later takes its place. */
  begin(key: string): AbortController {
    this.underWay.get(key)?.abort();
    const begun = new AbortController();
    this.underWay.set(key, begun);
    return begun;
  }

  /** It has ended; says whether it was still the newest. */
  end(key: string, ended: AbortController): boolean {
    return this.underWay.get(key) === ended && this.underWay.delete(key);
  }

  /** Ends all. */
  endAll(): void {
    for (const each of this.underWay.values()) {
      each.abort();
    }
    this.underWay.clear();
  }
}
