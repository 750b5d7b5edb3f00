/** Where the figures of runs are. Nothing here knows VS Code, so that it can be tested alone. */

import { mkdir, mkdtemp, readdir, rm, stat } from "node:fs/promises";
import * as path from "node:path";

/** Milliseconds for which a figure is kept: a window that is loaded again shows it again. */
const KEPT = 24 * 3600_000;

export class Figures {
  /** All figures are in folders of their own in this one, which other windows use, too. */
  constructor(private readonly folder: string) {}

  /** A file for the figure of an environment, in a folder that nothing else is in. */
  async file(environment: string): Promise<string> {
    await mkdir(this.folder, { recursive: true });
    return path.join(await mkdtemp(path.join(this.folder, "run-")), `${environment}.png`);
  }

  /** Removes those of more than a day ago. */
  async removeOld(now = Date.now()): Promise<void> {
    const names = await readdir(this.folder).catch(() => []);
    await Promise.all(names.map((name) => this.removeIfOld(path.join(this.folder, name), now)));
  }

  private async removeIfOld(folder: string, now: number): Promise<void> {
    try {
      if (now - (await stat(folder)).mtimeMs > KEPT) {
        await rm(folder, { recursive: true });
      }
    } catch {
      // Another window has removed it, or it is removed the next time.
    }
  }
}
