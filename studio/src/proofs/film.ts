/** A counterexample, step by step, with who communicates and who waits marked in the diagram. */

import { type Diagram, NOTHING } from "../diagram/diagram";
import type { Counterexample, Step, Waiting } from "../engine/messages";
import { button, h } from "../page/dom";
import { clock } from "../run/track";
import * as waits from "../run/waits";

const PACE = 1200;

function isWaiting(found: unknown): found is Waiting[] {
  return Array.isArray(found) && found.every((each) => typeof each === "object" && each !== null && "process" in each && "channels" in each);
}

/** The steps, those that can be repeated forever, and the state at the end if it says who waits. */
export function scenes(counterexample: Counterexample): Step[] {
  const { final, cycle } = counterexample;
  const repeated = (cycle ?? []).map((step) => ({ ...step, text: `${step.text}, again and again` }));
  const steps = [...counterexample.steps, ...repeated];
  const end: unknown = typeof final === "object" && final !== null && "waiting" in final ? final.waiting : final;
  const text = typeof final === "object" && final !== null && "text" in final && typeof final.text === "string" ? final.text : "The program stands still.";
  return isWaiting(end) && end.length > 0 ? [...steps, { text, waiting: end }] : steps;
}

export class Film {
  private steps: Step[] = [];
  private index = 0;
  private timer: ReturnType<typeof setInterval> | undefined;
  private title = "";
  /** Where the keyboard was before. */
  private before: Element | null = null;

  constructor(
    private readonly room: HTMLElement,
    private readonly diagram: Diagram,
  ) {
    room.addEventListener("keydown", (event) => this.key(event));
  }

  open(title: string, counterexample: Counterexample): void {
    this.close();
    this.before = document.activeElement;
    this.title = title;
    this.steps = scenes(counterexample);
    this.index = 0;
    this.room.hidden = false;
    this.paint();
    this.room.focus();
  }

  close(): void {
    this.stop();
    if (!this.room.hidden) {
      const hadFocus = this.room.contains(document.activeElement);
      this.room.hidden = true;
      this.diagram.mark(NOTHING);
      if (hadFocus && this.before instanceof HTMLElement) {
        this.before.focus();
      }
    }
  }

  private key(event: KeyboardEvent): void {
    if (event.key === "ArrowRight") {
      this.move(1);
    } else if (event.key === "ArrowLeft") {
      this.move(-1);
    } else if (event.key === "Escape") {
      this.close();
    } else {
      return;
    }
    event.preventDefault();
  }

  private move(by: number): void {
    this.stop();
    this.index = Math.min(Math.max(this.index + by, 0), this.steps.length - 1);
    this.paint();
  }

  private play(): void {
    if (this.timer !== undefined) {
      this.stop();
      this.paint();
      return;
    }
    if (this.index === this.steps.length - 1) {
      this.index = 0;
    }
    this.timer = setInterval(() => {
      this.index += 1;
      if (this.index >= this.steps.length - 1) {
        this.index = this.steps.length - 1;
        this.stop();
      }
      this.paint();
    }, PACE);
    this.paint();
  }

  private stop(): void {
    clearInterval(this.timer);
    this.timer = undefined;
  }

  private paint(): void {
    const step = this.steps[this.index];
    if (step === undefined) {
      return;
    }
    const focused = document.activeElement?.getAttribute("data-act");
    const last = this.index === this.steps.length - 1;
    const acts = [
      button("‹", () => this.move(-1), { "aria-label": "Previous step", "data-act": "previous", disabled: this.index === 0 ? "" : undefined }),
      button(this.timer === undefined ? "Play" : "Pause", () => this.play(), { "data-act": "play" }),
      button("›", () => this.move(1), { "aria-label": "Next step", "data-act": "next", disabled: last ? "" : undefined }),
      button("Close", () => this.close(), { class: "quiet", "data-act": "close" }),
    ];
    const list = h(
      "ol",
      { tabindex: "0", "aria-label": "Steps" },
      ...this.steps.map((each, index) => {
        const when = each.time == null ? "" : `${clock(each.time)} `;
        const row = h("li", index === this.index ? { "aria-current": "step" } : {}, button(`${when}${each.text}`, () => this.move(index - this.index), { class: "link" }));
        return row;
      }),
    );
    const waiting = step.waiting ?? [];
    this.room.replaceChildren(
      h("header", {}, h("h3", {}, "Counterexample"), h("span", { class: "title" }, this.title)),
      h("div", { class: "acts" }, ...acts, h("output", {}, `${this.index + 1} of ${this.steps.length}`)),
      h("p", { class: "caption", "aria-live": "polite" }, step.text),
      waiting.length === 0 ? "" : waits.list(waiting),
      list,
    );
    if (focused != null) {
      this.room.querySelector<HTMLElement>(`[data-act=${focused}]`)?.focus();
    }
    const current = list.querySelector<HTMLElement>("[aria-current]");
    list.scrollTop = (current?.offsetTop ?? 0) - list.clientHeight / 2;
    this.diagram.mark({ stuck: waiting, communicating: step.channel == null ? [] : [step.channel] });
  }
}
