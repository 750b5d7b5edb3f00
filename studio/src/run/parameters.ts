/** Sliders for the parameters of the program, which can be changed while it runs. */

import type { ParameterInfo } from "../engine/messages";
import { h } from "../page/dom";
import { unitOf } from "./plots";
import { short } from "./track";

/** From where to where a slider goes: what the engine says, or around the value of the text. */
export function bounds(parameter: ParameterInfo, value: number): [number, number] {
  const reach = value === 0 ? 1 : Math.abs(value);
  return [parameter.low ?? (value < 0 ? -2 * reach : value === 0 ? -1 : 0), parameter.high ?? (value < 0 ? 0 : value === 0 ? 1 : 2 * reach)];
}

export class Parameters {
  constructor(
    private readonly room: HTMLElement,
    private readonly tune: (parameter: ParameterInfo, value: unknown) => void,
  ) {}

  open(parameters: readonly ParameterInfo[]): void {
    const rows = parameters.flatMap((parameter) => {
      const { value } = parameter;
      if (typeof value === "boolean") {
        return [this.choice(parameter, value)];
      }
      return typeof value === "number" ? [this.slider(parameter, value)] : [];
    });
    this.room.replaceChildren(...rows);
    this.room.hidden = rows.length === 0;
  }

  private slider(parameter: ParameterInfo, value: number): HTMLElement {
    const [low, high] = bounds(parameter, value);
    const whole = /^u?int/.test(parameter.type);
    const step = whole ? 1 : (high - low) / 400;
    const slider = h("input", { type: "range", min: String(low), max: String(high), step: String(step) });
    slider.value = String(value);
    const shown = h("output", {}, short(value));
    const unit = unitOf(parameter);
    slider.addEventListener("input", () => {
      shown.textContent = short(slider.valueAsNumber);
      this.tune(parameter, slider.valueAsNumber);
    });
    const back = () => {
      slider.value = String(value);
      shown.textContent = short(value);
      this.tune(parameter, value);
    };
    slider.addEventListener("dblclick", back);
    slider.addEventListener("keydown", (event) => {
      if (event.key === "Escape") {
        back();
      }
    });
    return h("label", { title: "Double-click or Escape: as in the text" }, h("span", {}, parameter.name), slider, shown, h("span", { class: "unit" }, unit));
  }

  private choice(parameter: ParameterInfo, value: boolean): HTMLElement {
    const box = h("input", { type: "checkbox" });
    box.checked = value;
    box.addEventListener("change", () => this.tune(parameter, box.checked));
    return h("label", {}, h("span", {}, parameter.name), box);
  }
}
