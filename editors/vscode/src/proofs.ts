/** The proofs that the server has been asked for. Nothing here knows VS Code, so that it can be tested alone. */

/** The title of a lens whose proof the end of the server has interrupted. */
export const INTERRUPTED = "Verify again (interrupted)";

/** Knows the proofs that are under way, and those that ended with the server. An assertion is known by its file and text. */
export class Proofs {
  private readonly underWay = new Set<{ assertion: string }>();
  private readonly interrupted = new Set<string>();

  /** Waits for a proof; one that ends with the server has no answer, and has not failed. */
  async during<T>(assertion: string, ask: () => PromiseLike<T>): Promise<T | undefined> {
    const proof = { assertion };
    this.underWay.add(proof);
    this.interrupted.delete(assertion);
    try {
      return await ask();
    } catch (problem) {
      if (!this.underWay.has(proof)) {
        return undefined;
      }
      throw problem;
    } finally {
      this.underWay.delete(proof);
    }
  }

  /** The server has ended, or is about to. */
  serverEnded(): void {
    for (const { assertion } of this.underWay) {
      this.interrupted.add(assertion);
    }
    this.underWay.clear();
  }

  wasInterrupted(assertion: string): boolean {
    return this.interrupted.has(assertion);
  }
}
