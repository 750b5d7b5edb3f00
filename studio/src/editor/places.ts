/** Places as the engine counts them, and offsets as the editor does. */

import type { Text } from "@codemirror/state";
import type { Place, Position } from "../engine/messages";

export function offset(text: Text, at: Position): number {
  const line = text.line(Math.min(Math.max(at.line + 1, 1), text.lines));
  return Math.min(line.from + Math.max(at.character, 0), line.to);
}

export function position(text: Text, at: number): Position {
  const line = text.lineAt(at);
  return { line: line.number - 1, character: at - line.from };
}

/** Whether a place contains a position of a file. */
export function contains(place: Place, file: string, at: Position): boolean {
  const { start, end } = place;
  return (
    place.file === file &&
    (start.line < at.line || (start.line === at.line && start.character <= at.character)) &&
    (at.line < end.line || (at.line === end.line && at.character <= end.character))
  );
}

/** Whether the first place lies within the second and is not the same. */
export function smaller(first: Place, second: Place): boolean {
  const size = ({ start, end }: Place) => (end.line - start.line) * 10_000 + (end.character - start.character);
  return size(first) < size(second);
}
