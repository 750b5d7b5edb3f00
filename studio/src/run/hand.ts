/** Stick, buttons and values of a hand that takes over inputs of the program. */

import type { Signal, Value } from "../engine/messages";
import { button, h, options } from "../page/dom";
import { unitOf } from "./plots";

type Send = (name: string, value: Value) => void;

const BUTTONS = 4;
const DEAD = 0.08;
const KEY_STEP = 0.1;

/** The signals that a stick moves, most likely: numbers without a unit, named like its two axes. */
export function axes(signals: readonly Signal[]): { x: string; y: string } {
  const free = signals.filter((signal) => signal.hand && /^(?:double|float)/.test(signal.type) && unitOf(signal) === "");
  const named = (pattern: RegExp) => free.find((signal) => pattern.test(signal.name))?.name;
  const x = named(/horizontal|(?:^|[._])x$|pan/i) ?? free[0]?.name ?? "";
  const y = named(/vertical|(?:^|[._])y$|tilt/i) ?? free.find((signal) => signal.name !== x)?.name ?? "";
  return { x, y };
}

class Stick {
  readonly element: HTMLElement;
  private readonly knob = h("i", { class: "knob", "aria-hidden": "true" });
  private readonly pad = h(
    "div",
    {
      class: "pad",
      role: "slider",
      tabindex: "0",
      "aria-label": "Stick: arrow keys move it, 0 lets go",
      "aria-valuemin": "-1",
      "aria-valuemax": "1",
    },
    this.knob,
  );
  private readonly horizontal = h("select", { "aria-label": "Input of the stick's horizontal axis" });
  private readonly vertical = h("select", { "aria-label": "Input of the stick's vertical axis" });
  private x = 0;
  private y = 0;

  constructor(
    signals: readonly Signal[],
    private readonly send: Send,
  ) {
    const chosen = axes(signals);
    const numbers = signals.filter((signal) => signal.hand && /^(?:double|float)/.test(signal.type));
    for (const [select, name] of [
      [this.horizontal, chosen.x],
      [this.vertical, chosen.y],
    ] as const) {
      options(select, [["", "none"], ...numbers.map((signal) => [signal.name, signal.name] as const)]);
      select.value = name;
    }
    this.element = h(
      "div",
      { class: "stick" },
      this.pad,
      h("div", { class: "axes" }, h("label", {}, "↔ ", this.horizontal), h("label", {}, "↕ ", this.vertical)),
    );
    this.move(0, 0, false);
    this.pad.addEventListener("pointerdown", (event) => this.held(event));
    this.pad.addEventListener("keydown", (event) => this.key(event));
  }

  move(x: number, y: number, send = true): void {
    const bounded = (value: number) => Math.min(1, Math.max(-1, Math.round(value * 1000) / 1000));
    [this.x, this.y] = [bounded(x), bounded(y)];
    this.knob.style.left = `${50 + this.x * 36}%`;
    this.knob.style.top = `${50 - this.y * 36}%`;
    this.pad.setAttribute("aria-valuenow", String(this.x));
    this.pad.setAttribute("aria-valuetext", `horizontal ${this.x}, vertical ${this.y}`);
    if (send) {
      for (const [select, value] of [
        [this.horizontal, this.x],
        [this.vertical, this.y],
      ] as const) {
        if (select.value !== "") {
          this.send(select.value, value);
        }
      }
    }
  }

  release(): void {
    this.move(0, 0, false);
  }

  private held(down: PointerEvent): void {
    this.pad.setPointerCapture(down.pointerId);
    const to = (event: PointerEvent) => {
      const room = this.pad.getBoundingClientRect();
      const along = (at: number, start: number, length: number) => ((at - start) / length - 0.5) / 0.36;
      this.move(along(event.clientX, room.left, room.width), -along(event.clientY, room.top, room.height));
    };
    const end = () => {
      this.pad.removeEventListener("pointermove", to);
      this.pad.removeEventListener("lostpointercapture", end);
      this.move(0, 0);
    };
    this.pad.addEventListener("pointermove", to);
    this.pad.addEventListener("lostpointercapture", end);
    to(down);
  }

  private key(event: KeyboardEvent): void {
    const moves: Record<string, [number, number]> = {
      ArrowLeft: [-KEY_STEP, 0],
      ArrowRight: [KEY_STEP, 0],
      ArrowUp: [0, KEY_STEP],
      ArrowDown: [0, -KEY_STEP],
    };
    const by = moves[event.key];
    if (by !== undefined) {
      this.move(this.x + by[0], this.y + by[1]);
    } else if (event.key === "0" || event.key === "Home" || event.key === "Escape") {
      this.move(0, 0);
    } else {
      return;
    }
    event.preventDefault();
  }
}

/** A button that holds as long as it is pressed, by pointer or by key. */
function held(label: string, name: string, press: (down: boolean) => void): HTMLButtonElement {
  const made = h("button", { type: "button", class: "hold", "aria-label": name }, label);
  let down = false;
  const set = (to: boolean) => {
    if (down !== to) {
      down = to;
      made.classList.toggle("down", to);
      press(to);
    }
  };
  made.addEventListener("pointerdown", () => set(true));
  for (const end of ["pointerup", "pointercancel", "pointerleave", "blur"]) {
    made.addEventListener(end, () => set(false));
  }
  made.addEventListener("keydown", (event) => {
    if (event.key === " " || event.key === "Enter") {
      set(true);
      event.preventDefault();
    }
  });
  made.addEventListener("keyup", () => set(false));
  return made;
}

/** All controls for the inputs that a hand may take over. */
export class Hand {
  private stick: Stick | undefined;
  private buttons: Signal | undefined;
  private pressed = 0;
  private gamepad = "";

  constructor(
    private readonly room: HTMLElement,
    private readonly send: Send,
  ) {}

  open(signals: readonly Signal[]): void {
    const mine = signals.filter((signal) => signal.hand);
    const integers = mine.filter((signal) => /^u?int/.test(signal.type));
    this.buttons = integers.find((signal) => /button/i.test(signal.name));
    this.pressed = 0;
    const chosen = axes(mine);
    this.stick = chosen.x === "" ? undefined : new Stick(mine, this.send);
    const bits = this.buttons;
    const inStick = new Set([chosen.x, chosen.y, bits?.name]);
    const others = mine.filter((signal) => !inStick.has(signal.name));
    const parts = [
      this.stick?.element,
      bits === undefined ? undefined : this.bits(bits),
      others.length === 0 ? undefined : this.values(others, this.stick !== undefined),
    ];
    this.room.replaceChildren(...parts.filter((part) => part !== undefined));
    if (mine.length > 0) {
      const release = () => {
        this.stick?.release();
        mine.forEach((signal) => this.send(signal.name, null));
      };
      this.room.append(button("Let go", release, { title: "The environment drives all inputs again" }));
    }
    this.room.hidden = mine.length === 0;
  }

  private bits(signal: Signal): HTMLElement {
    const made = Array.from({ length: BUTTONS }, (_, bit) =>
      held(String(bit + 1), `Button ${bit + 1} of ${signal.name}`, (down) => {
        this.pressed = down ? this.pressed | (1 << bit) : this.pressed & ~(1 << bit);
        this.send(signal.name, this.pressed);
      }),
    );
    return h("div", { class: "buttons", role: "group", "aria-label": signal.name }, h("span", {}, signal.name), ...made);
  }

  private values(signals: readonly Signal[], folded: boolean): HTMLElement {
    const fields = signals.map((signal) => this.value(signal));
    return h("details", folded ? { class: "values" } : { class: "values", open: "" }, h("summary", {}, "Other inputs"), ...fields);
  }

  private value(signal: Signal): HTMLElement {
    if (/^bool/.test(signal.type)) {
      return held(signal.name, signal.name, (down) => this.send(signal.name, down));
    }
    if (signal.literals != null) {
      const select = h("select", {}, new Option("environment", ""), ...signal.literals.map((each) => new Option(each, each)));
      select.addEventListener("change", () => this.send(signal.name, select.value === "" ? null : select.value));
      return h("label", {}, h("span", {}, signal.name), select);
    }
    const whole = /^u?int/.test(signal.type);
    const field = h("input", { type: "number", step: whole ? "1" : "any", placeholder: "environment" });
    field.addEventListener("change", () => {
      const value = field.valueAsNumber;
      this.send(signal.name, Number.isNaN(value) ? null : value);
    });
    return h("label", {}, h("span", {}, signal.name), field, h("span", { class: "unit" }, unitOf(signal)));
  }

  /** Follows the first gamepad, if one moves. */
  poll(): void {
    const pad = navigator.getGamepads().find((each) => each?.connected === true);
    if (pad == null || this.stick === undefined) {
      return;
    }
    const [x = 0, y = 0] = pad.axes.map((value) => (Math.abs(value) < DEAD ? 0 : value));
    const bits = pad.buttons.slice(0, 16).reduce((all, each, bit) => (each.pressed ? all | (1 << bit) : all), 0);
    const state = `${x.toFixed(3)} ${y.toFixed(3)} ${bits}`;
    if (state !== this.gamepad && !(this.gamepad === "" && x === 0 && y === 0 && bits === 0)) {
      this.stick.move(x, -y);
      if (this.buttons !== undefined) {
        this.send(this.buttons.name, bits);
      }
    }
    this.gamepad = state;
  }
}
