/** Finds out whether the other side of a connection answers. */

/** Milliseconds without an answer after which it is said that there is none. */
const PATIENCE = 3000;

export class Pings {
  /** When the ping was sent that is not answered yet. */
  private sent: number | undefined;
  private silent = false;

  constructor(
    private readonly ping: () => void,
    private readonly changed: (silent: boolean) => void,
  ) {}

  /** To be called every now and then, with the time in milliseconds. */
  tick(now: number): void {
    if (this.sent === undefined) {
      this.sent = now;
      this.ping();
    } else if (now - this.sent >= PATIENCE) {
      this.say(true);
    }
  }

  /** Something has arrived, whatever it is. */
  heard(): void {
    this.sent = undefined;
    this.say(false);
  }

  private say(silent: boolean): void {
    if (this.silent !== silent) {
      this.silent = silent;
      this.changed(silent);
    }
  }
}
