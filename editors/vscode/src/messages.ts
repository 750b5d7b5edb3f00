/** What the extension and the page of the diagram say to each other. */

export type Which = "both" | "communication" | "composition";

/** To the page. */
export type ToPage =
  | { type: "picture"; svg: string; chosen: Chosen; processes: string[]; parts: Record<string, PagePart> }
  /** What is to be known about the picture; empty if nothing is. `stale`: the text has changed since. */
  | { type: "status"; text: string; stale: boolean }
  /** The elements at the cursor, by identifier. */
  | { type: "lit"; ids: readonly string[]; reveal: boolean }
  /** A step of a counterexample; `text` is empty if none is shown. */
  | { type: "step"; text: string; position: string; isFirst: boolean; isLast: boolean; communicating: string[]; waiting: string[] };

/** What a diagram is of, which is kept when the window is loaded again; without a `process` it is that at the cursor. */
export interface Chosen {
  uri?: string | undefined;
  process?: string | undefined;
  which: Which;
}

/** What the page knows of an element. */
export interface PagePart {
  /** Whether its inside has a diagram of its own. */
  opens: boolean;
}

/** From the page. */
export type FromPage =
  | { type: "ready" }
  | { type: "source"; id: string }
  | { type: "inside"; id: string }
  | { type: "process"; name: string }
  | { type: "which"; which: Which }
  | { type: "export" }
  | { type: "move"; by: number }
  | { type: "leave" };
