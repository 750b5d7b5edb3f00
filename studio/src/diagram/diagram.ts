/** The diagram beside the text: drawn while the text is written, lit by the cursor, by runs and by proofs. */

import { Picture } from "../../../editors/vscode/src/webview/picture";
import { type Engine, inWords } from "../engine/engine";
import type { DrawResult, Place, Position, Waiting } from "../engine/messages";
import { element, options, settled } from "../page/dom";
import type { Workspace } from "../program/workspace";
import { Elements } from "./elements";

/** The state of a run, or of a step of a counterexample; names are paths. */
export interface Marks {
  running?: readonly string[];
  communicating?: readonly string[];
  /** Who waits, as programs do all the time. */
  waiting?: readonly Waiting[];
  /** Who waits forever. */
  stuck?: readonly Waiting[];
}

export const NOTHING: Marks = {};

/** Milliseconds after which it is said that a diagram is being drawn. */
const SLOW = 600;
/** Milliseconds without a key until what is not shown is searched, too. */
const PAUSE = 400;

export class Diagram {
  private readonly room = element("diagram", HTMLElement);
  private readonly status = element("diagram-status", HTMLElement);
  private readonly view = element("view", HTMLSelectElement);
  private readonly process = element("process", HTMLSelectElement);
  private readonly depth = element("depth", HTMLSelectElement);
  private readonly search = element("search", HTMLInputElement);
  private readonly count = element("found", HTMLOutputElement);
  private readonly picture: Picture;
  private elements = new Elements();
  private drawing = false;
  private again = false;
  private found = 0;
  private marks = NOTHING;

  constructor(
    private readonly engine: Engine,
    private readonly workspace: Workspace,
    private readonly go: (place: Place) => void,
  ) {
    this.picture = new Picture(this.room, {
      source: (id) => {
        const place = this.elements.all.find((each) => each.id === id)?.places?.[0];
        if (place !== undefined) {
          go(place);
        }
      },
      inside: (id) => {
        const path = this.elements.all.find((each) => each.id === id)?.path ?? "";
        this.process.add(new Option(path, path));
        this.process.value = path;
        this.draw();
      },
    });
    for (const select of [this.view, this.process, this.depth]) {
      select.addEventListener("change", () => this.draw());
    }
    element("larger", HTMLButtonElement).addEventListener("click", () => this.picture.larger());
    element("smaller", HTMLButtonElement).addEventListener("click", () => this.picture.smaller());
    element("fit", HTMLButtonElement).addEventListener("click", () => this.picture.fit());
    const unfoldSoon = settled(PAUSE, () => void this.unfold());
    this.search.addEventListener("input", () => {
      this.found = 0;
      this.showFound();
      unfoldSoon();
    });
    this.search.addEventListener("keydown", (event) => {
      if (event.key === "Enter") {
        this.found += event.shiftKey ? -1 : 1;
        this.showFound();
      } else if (event.key === "Escape") {
        this.search.value = "";
        this.showFound();
      }
    });
    new ResizeObserver(() => this.picture.resize()).observe(this.room);
  }

  /** A program is opened: its outermost process is shown. */
  reset(): void {
    this.process.replaceChildren();
    this.search.value = "";
    this.mark(NOTHING);
  }

  /** Draws what is open; while it is drawn, only the last of several changes is remembered. */
  draw(): void {
    if (this.drawing) {
      this.again = true;
      return;
    }
    this.drawing = true;
    void this.drawn().finally(() => {
      this.drawing = false;
      if (this.again) {
        this.again = false;
        this.draw();
      }
    });
  }

  /** The engine's diagram of what is chosen, with so many levels. */
  private requested(depth: number): Promise<DrawResult> {
    const of = this.process.value;
    return this.engine.request("draw", {
      ...this.workspace.sources(),
      view: this.view.value,
      ...(of === "" ? {} : { of }),
      ...(depth > 1 ? { depth } : {}),
    });
  }

  private async drawn(): Promise<void> {
    const slow = setTimeout(() => this.say("Drawing …", false), SLOW);
    try {
      const result = await this.requested(Number(this.depth.value));
      clearTimeout(slow);
      this.show(result);
    } catch (problem) {
      clearTimeout(slow);
      this.say(inWords(problem));
    }
  }

  private show(result: DrawResult): void {
    const parts = result.elements.map((each) => [each.id, { opens: result.definitions.includes(each.definition ?? "") }] as const);
    if (!this.picture.show(result.svg, Object.fromEntries(parts))) {
      this.say("The picture of the engine cannot be read.");
      return;
    }
    this.elements = new Elements(result.elements);
    const { definitions, of } = result;
    const chosen = this.process.value;
    const names = chosen === "" || definitions.includes(of) ? definitions : [of, ...definitions];
    options(this.process, [["", "Whole program"], ...names.map((name) => [name, name] as const)]);
    this.say("");
    this.paint();
    this.showFound();
  }

  private say(text: string, bad = true): void {
    this.status.classList.toggle("bad", bad);
    this.status.textContent = text;
    this.status.hidden = text === "";
    this.room.classList.toggle("stale", text !== "");
  }

  /** Lights what the cursor is on. */
  light(file: string, at: Position): void {
    this.picture.mark("lit", this.elements.at(file, at));
  }

  mark(marks: Marks): void {
    this.marks = marks;
    this.paint();
  }

  private paint(): void {
    const { running = [], waiting = [], communicating = [], stuck = [] } = this.marks;
    this.picture.mark("running", this.elements.everyNamed(running));
    this.picture.mark("pending", this.elements.everyNamed(waiting.flatMap((each) => each.channels)));
    this.picture.mark("waiting", this.elements.waiting(stuck));
    this.picture.mark("communicating", this.elements.everyNamed(communicating));
  }

  /** What is searched and not shown may be inside of what is: as many levels are shown as it takes to find it. */
  private async unfold(): Promise<void> {
    const wanted = this.search.value;
    const isWanted = () => this.search.value === wanted && wanted.trim() !== "" && this.elements.search(wanted).length === 0;
    const deeper = [...this.depth.options].filter((each) => Number(each.value) > Number(this.depth.value));
    for (const { value } of deeper) {
      if (!isWanted()) {
        return;
      }
      try {
        const result = await this.requested(Number(value));
        if (isWanted() && new Elements(result.elements).search(wanted).length > 0) {
          this.depth.value = value;
          this.show(result);
        }
      } catch {
        // What cannot be drawn is said where it is shown.
        return;
      }
    }
  }

  private showFound(): void {
    const ids = this.elements.search(this.search.value);
    const present = ids.length === 0 ? undefined : ids.at(this.found % ids.length);
    this.picture.mark("found", ids);
    this.picture.reveal(this.picture.mark("present", present === undefined ? [] : [present]));
    this.count.textContent = this.search.value.trim() === "" ? "" : ids.length === 0 ? "none" : `${ids.length}`;
  }
}
