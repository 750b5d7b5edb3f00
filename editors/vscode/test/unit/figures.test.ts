import assert from "node:assert/strict";
import { existsSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import * as path from "node:path";
import { test } from "node:test";
import { Figures } from "../../src/figures";

test("figures of yesterday are removed, those of today are kept", async () => {
  const root = mkdtempSync(path.join(tmpdir(), "cspdiag-figures-"));
  try {
    const figures = new Figures(path.join(root, "figures"));
    await figures.removeOld();
    const figure = await figures.file("Bench");
    assert.notEqual(figure, await figures.file("Bench"));
    writeFileSync(figure, "");
    await figures.removeOld(Date.now() + 23 * 3600_000);
    assert.ok(existsSync(figure));
    await figures.removeOld(Date.now() + 25 * 3600_000);
    assert.ok(!existsSync(path.dirname(figure)));
  } finally {
    rmSync(root, { recursive: true });
  }
});
