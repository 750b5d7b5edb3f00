/** Sliders for the parameters of the program, and for the parts of those that are structs. */

import type { Field, ParameterInfo, Value } from "../engine/messages";
import { h } from "../page/dom";
import { unitOf } from "./plots";
import { short } from "./track";

/** Of more than this number the sliders are shown when they are wanted. */
const FEW = 6;

/** From where to where a slider goes, around the value of the text. */
export function bounds(value: number): [number, number] {
  return value > 0 ? [0, 2 * value] : value < 0 ? [2 * value, 0] : [-1, 1];
}

/** Nanoseconds as a person writes them. */
export function duration(value: number): string {
  const units: [number, string][] = [[1e9, "s"], [1e6, "ms"], [1e3, "us"]];
  const [size, unit] = units.find(([each]) => Math.abs(value) >= each) ?? [1, value === 0 ? "s" : "ns"];
  return `${short(value / size)} ${unit}`;
}

export class Parameters {
  /** What is not as in the text; a run begins with it. */
  readonly changed = new Map<string, Value>();

  constructor(
    private readonly room: HTMLElement,
    private readonly tune: (name: string, value: Value) => void,
  ) {}

  /** Shows parameters as they are in the text. */
  open(parameters: readonly ParameterInfo[]): void {
    this.changed.clear();
    const rows = parameters.flatMap((parameter) => (parameter.fields ?? [parameter]).flatMap((field) => this.row(field)));
    const body = h("details", rows.length <= FEW ? { open: "" } : {}, h("summary", {}, `Parameters (${rows.length})`), ...rows);
    this.room.replaceChildren(body);
    this.room.hidden = rows.length === 0;
  }

  private row(field: Field): HTMLElement[] {
    const { value, literals } = field;
    if (typeof value === "boolean") {
      return [this.box(field, value)];
    }
    if (typeof value === "string" && literals != null) {
      return [this.choice(field, value, literals)];
    }
    return typeof value === "number" ? [this.slider(field, value)] : [];
  }

  /** A value is chosen, which is that of the text or another one. */
  private set(name: string, value: Value, isOfText: boolean): void {
    if (isOfText) {
      this.changed.delete(name);
    } else {
      this.changed.set(name, value);
    }
    this.tune(name, value);
  }

  private slider(field: Field, value: number): HTMLElement {
    const [low, high] = bounds(value);
    const time = field.type === "time";
    const whole = time || /^u?int/.test(field.type);
    const step = time ? Math.max(1, Math.round((high - low) / 400)) : whole ? 1 : (high - low) / 400;
    const slider = h("input", { type: "range", min: String(low), max: String(high), step: String(step) });
    slider.value = String(value);
    const text = (now: number) => (time ? duration(now) : short(now));
    const shown = h("output", {}, text(value));
    const set = (now: number) => {
      shown.textContent = text(now);
      this.set(field.name, time ? `${Math.round(now)} ns` : now, now === value);
    };
    slider.addEventListener("input", () => set(slider.valueAsNumber));
    const back = () => {
      slider.value = String(value);
      set(value);
    };
    slider.addEventListener("dblclick", back);
    slider.addEventListener("keydown", (event) => {
      if (event.key === "Escape") {
        back();
      }
    });
    const unit = h("span", { class: "unit" }, unitOf(field));
    return h("label", { title: "Double-click or Escape: as in the text" }, h("span", {}, field.name), slider, shown, unit);
  }

  private box(field: Field, value: boolean): HTMLElement {
    const box = h("input", { type: "checkbox" });
    box.checked = value;
    box.addEventListener("change", () => this.set(field.name, box.checked, box.checked === value));
    return h("label", {}, h("span", {}, field.name), box);
  }

  private choice(field: Field, value: string, literals: readonly string[]): HTMLElement {
    const select = h("select", {}, ...literals.map((each) => new Option(each, each)));
    select.value = value;
    select.addEventListener("change", () => this.set(field.name, select.value, select.value === value));
    return h("label", {}, h("span", {}, field.name), select);
  }
}
