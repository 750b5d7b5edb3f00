/** The moving picture of a plant: an SVG beside the program, whose attributes say which signals move its parts. */

import { safe } from "../../../editors/vscode/src/webview/picture";
import type { Program } from "../engine/messages";
import { h } from "../page/dom";

/** `signal * factor + summand`; without a factor it is 1, without a summand 0. */
export interface Formula {
  signal: string;
  factor: number;
  summand: number;
}

const NUMBER = String.raw`[+-]?\d+(?:\.\d+)?(?:[eE][+-]?\d+)?`;
const FORMULA = new RegExp(String.raw`^\s*([A-Za-z_][A-Za-z0-9_.]*)\s*(?:\*\s*(${NUMBER}))?\s*(?:([+-])\s*(\d+(?:\.\d+)?(?:[eE][+-]?\d+)?))?\s*$`);

export function formula(text: string): Formula | undefined {
  const found = FORMULA.exec(text);
  if (found === null) {
    return undefined;
  }
  const [, signal = "", factor = "1", sign = "+", summand = "0"] = found;
  return { signal, factor: Number(factor), summand: sign === "-" ? -Number(summand) : Number(summand) };
}

/** `0: grey; 0.5: #c00`: the colour of the highest threshold that a value reaches. */
export function colourOf(steps: string, value: number): string | undefined {
  let [best, colour] = [-Infinity, undefined as string | undefined];
  for (const step of steps.split(";")) {
    const at = step.indexOf(":");
    const threshold = Number(step.slice(0, at));
    const name = step.slice(at + 1).trim();
    if (at > 0 && threshold <= value && threshold >= best && /^(?:#[0-9a-fA-F]{3,8}|[a-zA-Z]+|var\(--[a-z0-9-]+\))$/.test(name)) {
      [best, colour] = [threshold, name];
    }
  }
  return colour;
}

/** The file of the picture of an environment: named after it, or else after the program. */
export function pictureOf(program: Program, environment: string): string | undefined {
  const folder = program.main.slice(0, program.main.lastIndexOf("/") + 1);
  const stem = program.main.replace(/\.csp$/, "");
  return program.files[`${folder}${environment}.svg`] ?? program.files[`${stem}.svg`];
}

/** The attributes that move a part, and how. */
const MOVES = ["data-rotate", "data-x", "data-y", "data-scale-x", "data-scale-y"] as const;

type Value = (signal: string) => number | undefined;

interface Part {
  element: SVGElement;
  /** Its own transform, which the motion comes after. */
  before: string;
  /** Around what it turns and is stretched. */
  centre: [number, number];
  formulas: Map<string, Formula>;
}

function transform({ before, centre, formulas }: Part, value: Value): string {
  const of = (name: (typeof MOVES)[number]) => {
    const found = formulas.get(name);
    const now = found === undefined ? undefined : value(found.signal);
    return found === undefined || now === undefined ? undefined : now * found.factor + found.summand;
  };
  const [x, y, angle] = [of("data-x"), of("data-y"), of("data-rotate")];
  const [wide, high] = [of("data-scale-x"), of("data-scale-y")];
  const steps = [before];
  if (x !== undefined || y !== undefined) {
    steps.push(`translate(${x ?? 0} ${y ?? 0})`);
  }
  const [cx, cy] = centre;
  if (angle !== undefined) {
    steps.push(`rotate(${angle} ${cx} ${cy})`);
  }
  if (wide !== undefined || high !== undefined) {
    steps.push(`translate(${cx} ${cy}) scale(${wide ?? 1} ${high ?? 1}) translate(${-cx} ${-cy})`);
  }
  return steps.filter((step) => step !== "").join(" ");
}

/** The point of `data-centre`; undefined if it is not one. */
export function centreOf(text: string): [number, number] | undefined {
  const numbers = text.trim().split(/[\s,]+/).map(Number);
  const [x, y] = numbers;
  return numbers.length === 2 && x !== undefined && y !== undefined && numbers.every(Number.isFinite) ? [x, y] : undefined;
}

let pictures = 0;

/** Without styles, which would be those of the whole page, and with names that no other element of the page has. */
function apart(svg: SVGSVGElement): SVGSVGElement {
  pictures += 1;
  const own = (name: string) => `plant${pictures}-${name}`;
  for (const each of svg.querySelectorAll("*")) {
    if (each.localName === "style") {
      each.remove();
    }
  }
  for (const each of [svg, ...svg.querySelectorAll("*")]) {
    for (const { name, value } of [...each.attributes]) {
      const renamed = name === "id" ? own(value) : /(?:^|:)href$/i.test(name) ? value.replace(/^\s*#/, `#${own("")}`) : value;
      each.setAttribute(name, renamed.replace(/url\(\s*(["']?)#/g, `url($1#${own("")}`));
    }
  }
  return svg;
}

export class Plant {
  private parts: Part[] = [];

  constructor(private readonly room: HTMLElement) {}

  /** Shows the picture, if there is one that can be read; `signals` are those of the run. */
  open(text: string | undefined, signals: readonly string[]): boolean {
    const read = text === undefined ? undefined : safe(text);
    this.parts = [];
    this.room.replaceChildren();
    if (read === undefined) {
      return false;
    }
    const svg = apart(read);
    const wrong = new Set<string>();
    for (const element of svg.querySelectorAll<SVGElement>("*")) {
      const formulas = new Map<string, Formula>();
      for (const name of [...MOVES, "data-colour", "data-text"]) {
        const written = element.getAttribute(name);
        const read = written === null ? undefined : formula(written);
        if (read !== undefined && signals.includes(read.signal)) {
          formulas.set(name, read);
        } else if (written !== null) {
          wrong.add(read === undefined ? `${name}="${written}" is not a signal with a factor` : `there is no signal ${read.signal}`);
        }
      }
      const written = element.getAttribute("data-centre") ?? "0 0";
      const centre = centreOf(written);
      if (centre === undefined) {
        wrong.add(`data-centre="${written}" is not a point, as 50 50`);
      }
      if (formulas.size > 0) {
        this.parts.push({ element, before: element.getAttribute("transform") ?? "", centre: centre ?? [0, 0], formulas });
      }
    }
    // As long as nothing runs there are no signals.
    const shown = signals.length === 0 || wrong.size === 0 ? [] : [h("p", { class: "hint" }, `In this picture: ${[...wrong].join("; ")}.`)];
    this.room.append(svg, ...shown);
    return true;
  }

  /** Moves all parts to where the signals say; a signal without a value leaves its part where it is drawn. */
  show(value: Value): void {
    for (const part of this.parts) {
      const { element, formulas } = part;
      const moved = transform(part, value);
      if (moved !== "") {
        element.setAttribute("transform", moved);
      }
      const colour = formulas.get("data-colour");
      const shade = colour === undefined ? undefined : value(colour.signal);
      if (colour !== undefined && shade !== undefined) {
        element.style.fill = colourOf(element.getAttribute("data-colours") ?? "", shade * colour.factor + colour.summand) ?? "";
      }
      const text = formulas.get("data-text");
      const number = text === undefined ? undefined : value(text.signal);
      if (text !== undefined && number !== undefined) {
        const digits = Number(element.getAttribute("data-digits") ?? "2");
        const shown = (number * text.factor + text.summand).toFixed(Math.min(Math.max(digits, 0), 9));
        element.textContent = shown.replace(/^-(0(?:\.0*)?)$/, "$1");
      }
    }
  }
}
