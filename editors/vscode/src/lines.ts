/** A text that comes in pieces, such as what a command writes while it runs. */
export class Lines {
  private rest = "";

  /** The lines that are whole with a further piece. */
  take(piece: string): string[] {
    const lines = (this.rest + piece).split("\n");
    this.rest = lines.pop() ?? "";
    return lines;
  }

  /** What is left after the last piece: a line without an end, if there is one. */
  end(): string[] {
    const { rest } = this;
    this.rest = "";
    return rest === "" ? [] : [rest];
  }
}
