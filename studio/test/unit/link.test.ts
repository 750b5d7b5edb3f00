import assert from "node:assert/strict";
import { test } from "node:test";
import { deflateRawSync } from "node:zlib";
import { decoded, encoded } from "../../src/program/link";

const PROGRAM = { files: { "a.csp": "process A {}\n// größer ∞ 𝔸\n".repeat(50), "b.csp": "" }, main: "a.csp" };

test("a program comes back from its link", async () => {
  const link = await encoded(PROGRAM);
  assert.match(link, /^#code=[A-Za-z0-9_-]+$/);
  assert.deepEqual(await decoded(link), PROGRAM);
});

test("a link made elsewhere is read", async () => {
  const code = deflateRawSync(JSON.stringify(PROGRAM)).toString("base64url");
  assert.deepEqual(await decoded(`#code=${code}`), PROGRAM);
});

test("other fragments hold no program", async () => {
  assert.equal(await decoded(""), undefined);
  assert.equal(await decoded("#section"), undefined);
});

test("a link that holds more than a page can show says so", async () => {
  const bomb = deflateRawSync(Buffer.alloc(50_000_000)).toString("base64url");
  await assert.rejects(decoded(`#code=${bomb}`), /too large: 4 MB/);
});

test("a damaged link is refused in words", async () => {
  const other = (value: unknown) => `#code=${deflateRawSync(JSON.stringify(value)).toString("base64url")}`;
  const damaged = ["#code=AAAA", "#code=", "#code=@@@@", "#code=AAAA BBBB", other(3), other({ files: { a: 1 }, main: "a" }), other({ files: {}, main: "toString" })];
  for (const link of damaged) {
    await assert.rejects(decoded(link), /copy the whole link/, link);
  }
});
