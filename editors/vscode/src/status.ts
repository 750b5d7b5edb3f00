/** What is said above the picture of a diagram. Nothing here knows VS Code. */

/** Milliseconds for which a picture stays as it is while another is drawn: one of something else, one of an earlier text. */
const PATIENCE = { elsewhere: 500, changed: 2_000 };
export const BEING_DRAWN = "The diagram is being drawn.";

export class Status {
  private timer: NodeJS.Timeout | undefined;
  private said = "";

  /** `show` says a text; `stale`: the picture on the page is not what is wanted. */
  constructor(private readonly show: (text: string, stale: boolean) => void) {}

  /** Why there is no picture to export. */
  get whyNone(): string {
    const isDrawn = this.said === "" || this.said === BEING_DRAWN;
    return isDrawn ? "There is no diagram to export yet: it is being drawn." : this.said;
  }

  say(text: string, stale: boolean): void {
    this.stop();
    this.said = text;
    this.show(text, stale);
  }

  /** Nothing is known any more. */
  forget(): void {
    this.said = "";
  }

  /** Says that a picture is being drawn, unless something else is said soon. */
  wait(patience: keyof typeof PATIENCE): void {
    this.stop();
    this.timer = setTimeout(() => {
      this.say(BEING_DRAWN, true);
    }, PATIENCE[patience]);
  }

  stop(): void {
    clearTimeout(this.timer);
  }
}
