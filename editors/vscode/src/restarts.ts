/** How often the server is started again after it ended by itself. */

/** This many times within this many milliseconds; a server that ends more often is broken. */
const MOST = 4;
const WITHIN = 3 * 60_000;

export class Restarts {
  private ends: number[] = [];
  private said = false;

  constructor(private readonly now: () => number = Date.now) {}

  /** The server has ended: whether to start it again, and whether to say so, which is done once. */
  ended(): { again: boolean; say: boolean } {
    const now = this.now();
    this.ends = [...this.ends.filter((end) => now - end < WITHIN), now];
    const again = this.ends.length <= MOST;
    const say = again && !this.said;
    this.said ||= say;
    return { again, say };
  }
}
