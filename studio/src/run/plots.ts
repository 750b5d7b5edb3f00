/** Plots of the signals, one for each unit, which follow the run and show the instant that one looks at. */

import uPlot from "uplot";
import type { Signal } from "../engine/messages";
import { h } from "../page/dom";
import type { Recording } from "./recording";
import { type Track, literals, short } from "./track";

/** How many colours --series-1 … there are; a plot has no more signals. */
const COLOURS = 8;
const HEIGHT = 116;
/** The width of the vertical axis, and what the last label of the horizontal one needs; the modes have the same margins. */
const LEFT = 46;
const RIGHT = 20;
/** As many names of values as there is room for beside a plot, and characters of each. */
const MOST_NAMES = 5;
const MOST_CHARACTERS = 7;
/** As many numbers are beside a plot at least, if there are so many in its range. */
const FEWEST = 3;
/** Milliseconds between two paintings while the run goes on: a canvas takes longer than all else on the page. */
const PACE = 30;

interface Group {
  title: string;
  signals: Signal[];
}

/** Signals by what they can be compared with: their unit, and whether they are numbers; at most as many as colours. */
export function groups(signals: readonly Signal[]): Group[] {
  const found = new Map<string, Signal[]>();
  for (const signal of signals) {
    const unit = unitOf(signal);
    const kind = /^(?:double|float)/.test(signal.type) ? "" : /^bool/.test(signal.type) ? "yes or no" : signal.type.replace(/<.*/, "");
    const title = unit !== "" ? unit : kind !== "" ? kind : "without unit";
    found.set(title, [...(found.get(title) ?? []), signal]);
  }
  return [...found].flatMap(([title, all]) =>
    Array.from({ length: Math.ceil(all.length / COLOURS) }, (_, part) => ({ title, signals: all.slice(part * COLOURS, (part + 1) * COLOURS) })),
  );
}

export function unitOf(signal: { type: string; unit?: string | null }): string {
  const unit = signal.unit ?? /<(.*)>/.exec(signal.type)?.[1] ?? "";
  return unit === "1" ? "" : unit;
}

function colour(name: string): string {
  const probe = h("span", { class: "probe" });
  probe.style.color = `var(${name})`;
  document.body.append(probe);
  const found = getComputedStyle(probe).color;
  probe.remove();
  return found;
}

interface Shown {
  figure: HTMLElement;
  plot: uPlot;
  tracks: Track[];
  values: HTMLElement[];
}

export class Plots {
  private shown: Shown[] = [];
  private signals: readonly Signal[] = [];
  private recording: Recording | undefined;
  private painted = 0;
  /** The plots that can be seen; others are not painted. */
  private readonly seen = new Set<Element>();
  private readonly watch = new IntersectionObserver((entries) => {
    for (const { target, isIntersecting } of entries) {
      if (isIntersecting) {
        this.seen.add(target);
      } else {
        this.seen.delete(target);
      }
    }
    this.painted = 0;
    this.again();
  });

  constructor(
    private readonly room: HTMLElement,
    private readonly look: (at: number) => void,
    private readonly again: () => void,
  ) {
    new ResizeObserver(() => {
      for (const { plot } of this.shown) {
        plot.setSize({ width: this.width(), height: HEIGHT });
      }
    }).observe(room);
  }

  /** Plots for the signals of a run, in the present colours. */
  open(signals: readonly Signal[], recording: Recording): void {
    [this.signals, this.recording] = [signals, recording];
    for (const { plot } of this.shown) {
      plot.destroy();
    }
    this.room.replaceChildren();
    this.watch.disconnect();
    this.seen.clear();
    this.shown = groups(signals).map((group) => this.made(group, recording));
  }

  /** The same plots in other colours. */
  repaint(): void {
    if (this.recording !== undefined) {
      this.open(this.signals, this.recording);
    }
  }

  private width(): number {
    return Math.max(this.room.clientWidth, 200);
  }

  private made({ title, signals }: Group, recording: Recording): Shown {
    const values = signals.map(() => h("output", {}));
    const keys = signals.map((signal, index) => {
      const swatch = h("i", { class: `swatch series-${index + 1}`, "aria-hidden": "true" });
      return h("li", {}, swatch, h("span", {}, signal.name), values[index]);
    });
    const place = h("div", { class: "canvas" });
    const all = signals.map((signal) => signal.name).join(", ");
    const names = literals(signals[0] ?? {});
    const caption = h("figcaption", {}, h("b", {}, title), h("ul", {}, ...keys));
    const figure = h("figure", { class: "plot", "aria-label": `Plot of ${all}` }, caption, place);
    this.room.append(figure);
    this.watch.observe(figure);
    const axis = { stroke: colour("--faint"), grid: { stroke: colour("--grid"), width: 1 }, ticks: { show: false } };
    const font = "11px system-ui, sans-serif";
    const plot = new uPlot(
      {
        width: this.width(),
        height: HEIGHT,
        padding: [6, RIGHT, 0, 0],
        legend: { show: false },
        cursor: { sync: { key: "run" }, drag: { x: false, y: false }, points: { show: false }, y: false },
        scales: { x: { time: false }, y: { range: names.length === 0 ? (_, low, high) => around(low, high, isWhole(signals[0]?.type ?? "") ? 1 : 0) : around(0, names.length - 1) } },
        axes: [
          { ...axis, font, size: 22, gap: 2, values: (_, splits) => splits.map(instant) },
          { ...axis, font, size: LEFT, gap: 4, ...ticks(signals[0]?.type ?? "", names) },
        ],
        series: [
          {},
          ...signals.map((signal, index) => ({
            label: signal.name,
            stroke: colour(`--series-${index + 1}`),
            width: 1.5,
            points: { show: false },
            ...(uPlot.paths.stepped === undefined ? {} : { paths: uPlot.paths.stepped({ align: 1 }) }),
          })),
        ],
        hooks: { draw: [(drawn) => this.line(drawn)] },
      },
      [[], ...signals.map(() => [])],
      place,
    );
    plot.over.addEventListener("click", () => {
      const left = plot.cursor.left ?? -1;
      if (left >= 0) {
        this.look(plot.posToVal(left, "x") * 1e9);
      }
    });
    const tracks = signals.map((signal) => recording.tracks.get(signal.name)).filter((track) => track !== undefined);
    return { figure, plot, tracks, values };
  }

  private at = 0;

  /** The line at the instant that is shown. */
  private line(plot: uPlot): void {
    const x = plot.valToPos(this.at / 1e9, "x", true);
    const { left, top, width, height } = plot.bbox;
    if (x < left || x > left + width) {
      return;
    }
    plot.ctx.save();
    plot.ctx.strokeStyle = colour("--accent");
    plot.ctx.lineWidth = devicePixelRatio;
    plot.ctx.beginPath();
    plot.ctx.moveTo(x, top);
    plot.ctx.lineTo(x, top + height);
    plot.ctx.stroke();
    plot.ctx.restore();
  }

  /** Shows a stretch of time, and the values at an instant; what will be painted again soon is not hurried. */
  show(from: number, to: number, at: number, soon: boolean): void {
    if (soon && performance.now() - this.painted < PACE) {
      return;
    }
    this.painted = performance.now();
    this.at = at;
    for (const { figure, plot, tracks, values } of this.shown) {
      if (!this.seen.has(figure)) {
        continue;
      }
      const count = Math.max(Math.round(plot.width / 2), 50);
      const x: number[] = [];
      for (let column = 0; column < count; column++) {
        x.push((from + ((to - from) * column) / count) / 1e9, (from + ((to - from) * (column + 0.5)) / count) / 1e9);
      }
      plot.setData([x, ...tracks.map((track) => track.columns(from, to, count))], false);
      plot.setScale("x", { min: from / 1e9, max: to / 1e9 });
      tracks.forEach((track, index) => {
        const value = values[index];
        if (value !== undefined) {
          value.textContent = track.textAt(at);
        }
      });
    }
  }
}

/** The label of an instant, in seconds. */
export function instant(at: number): string {
  return Math.abs(at) < 1e-3 ? short(at) : `${at}`;
}

/** What is written beside a plot: names, or round numbers. */
export function ticks(type: string, names: readonly string[]): uPlot.Axis {
  if (names.length > 0) {
    return named(names);
  }
  const least = isWhole(type) ? 1 : 0;
  return { splits: (_, __, low, high) => round(low, high, least), values: (_, splits) => splits.map(label) };
}

function isWhole(type: string): boolean {
  return /^u?int/.test(type);
}

/** Multiples of 1, 2 or 5 with powers of ten that are in a range, at least `least` apart, and otherwise as far apart as leaves three. */
export function round(low: number, high: number, least: number): number[] {
  const power = 10 ** Math.floor(Math.log10(high - low));
  const steps = [5, 2, 1, 0.5, 0.2, 0.1].map((part) => Math.max(part * power, least));
  const within = (step: number) => {
    const [first, last] = [Math.ceil(low / step), Math.floor(high / step)];
    return Array.from({ length: Math.max(last - first + 1, 0) }, (_, index) => Number(((first + index) * step).toPrecision(12)));
  };
  const [widest = []] = steps.map(within).filter((found) => found.length >= FEWEST);
  return widest.length > 0 ? widest : within(steps.at(-1) ?? 1);
}

function label(value: number): string {
  const text = String(value);
  return text.length <= MOST_CHARACTERS ? text : value.toExponential(1);
}

/** What is written beside a plot of values that have names. */
export function named(names: readonly string[]): { splits: () => number[]; values: (plot: unknown, splits: number[]) => string[] } {
  const each = Math.ceil(names.length / MOST_NAMES);
  const shown = [...names.keys()].filter((index) => index % each === 0);
  const cut = (name: string) => (name.length > MOST_CHARACTERS ? `${name.slice(0, MOST_CHARACTERS - 1)}…` : name);
  return { splits: () => shown, values: (_, splits) => splits.map((index) => cut(names[index] ?? "")) };
}

/** A range around what there is to see, with some air, at least `least`. */
export function around(low: number | null, high: number | null, least = 0): [number, number] {
  if (low === null || high === null || !Number.isFinite(low) || !Number.isFinite(high)) {
    return [-1, 1];
  }
  const air = Math.max(high > low ? (high - low) * 0.08 : Math.max(Math.abs(high) * 0.1, 0.5), least);
  return [low - air, high + air];
}
