/** Elements of diagrams and the places in the text that they represent. */

/** As in the Language Server Protocol: lines and code units from 0. */
export interface Position {
  line: number;
  character: number;
}

export interface Range {
  start: Position;
  end: Position;
}

export interface Place {
  uri: string;
  range: Range;
}

/** An element of a diagram: its identifier in the SVG, its name in the diagram, and its places in the text. */
export interface Part {
  id: string;
  key: string;
  places: Place[];
  /** For an instance: its definition, if that has a diagram. */
  inside: string | null;
}

export interface Definition {
  name: string;
  range: Range;
}

/** The answer of the server to `cspdiag/diagram`; `problem` says why there is no picture. */
export interface Diagram {
  problem?: string;
  name: string;
  svg: string;
  /** Whether the text has no mistakes in its syntax. */
  whole: boolean;
  parts: Part[];
  definitions: Definition[];
}

/** Whether what is `shown`, of a text without mistakes in its syntax, tells more than a picture of a text with some. It
 * does not if another process is `wanted`, and that could be drawn. */
export function tellsMore(shown: Diagram | undefined, answer: Diagram, wanted: string | undefined): boolean {
  const isWanted = answer.name === wanted && answer.name !== shown?.name;
  return shown?.whole === true && !answer.whole && !isWanted;
}

/** The elements with the smallest place around a position. */
export function partsAt(parts: readonly Part[], uri: string, at: Position): Part[] {
  let best: { part: Part; range: Range }[] = [];
  for (const part of parts) {
    for (const { uri: file, range } of part.places) {
      if (file !== uri || !contains(range, at)) {
        continue;
      }
      const smallest = best[0]?.range;
      if (smallest === undefined || (contains(smallest, range.start) && contains(smallest, range.end))) {
        best = smallest !== undefined && same(smallest, range) ? [...best, { part, range }] : [{ part, range }];
      }
    }
  }
  return best.map((each) => each.part);
}

/** The definition around a position. */
export function definitionAt(definitions: readonly Definition[], at: Position): string | undefined {
  return definitions.find(({ range }) => contains(range, at))?.name;
}

function contains(range: Range, at: Position): boolean {
  return !isBefore(at, range.start) && !isBefore(range.end, at);
}

function isBefore(one: Position, other: Position): boolean {
  return one.line < other.line || (one.line === other.line && one.character < other.character);
}

function same(one: Range, other: Range): boolean {
  return contains(one, other.start) && contains(one, other.end) && contains(other, one.start) && contains(other, one.end);
}
