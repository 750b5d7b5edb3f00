/** The steps of a counterexample, one of which is shown. Nothing here knows VS Code. */

import type { ToPage } from "./messages";
import type { Diagram } from "./places";

/** A step of a counterexample, by the names of elements in the diagram of `process`. */
export interface Step {
  process: string;
  text: string;
  communicating: string[];
  waiting: string[];
}

export class Counterexample {
  private at = 0;

  constructor(private readonly steps: readonly Step[] = []) {}

  /** The step that is shown; undefined if there are none. */
  get step(): Step | undefined {
    return this.steps[this.at];
  }

  /** Goes forwards or backwards, as far as there are steps. */
  move(by: number): void {
    this.at = Math.min(Math.max(this.at + by, 0), Math.max(this.steps.length - 1, 0));
  }

  /** What the page shows of the step in a picture. */
  shownIn(picture: Diagram | undefined): ToPage {
    const { step } = this;
    if (step === undefined) {
      return { type: "step", text: "", position: "", isFirst: true, isLast: true, communicating: [], waiting: [] };
    }
    const isHere = step.process === picture?.name;
    const ids = (keys: readonly string[]) =>
      (picture?.parts ?? []).filter((part) => isHere && keys.includes(part.key)).map((part) => part.id);
    return {
      type: "step",
      text: isHere ? step.text : `This step is in the diagram of ${step.process}: ${step.text}`,
      position: `${this.at + 1}/${this.steps.length}`,
      isFirst: this.at === 0,
      isLast: this.at === this.steps.length - 1,
      communicating: ids(step.communicating),
      waiting: ids(step.waiting),
    };
  }
}
