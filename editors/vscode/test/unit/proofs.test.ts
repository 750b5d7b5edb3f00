import assert from "node:assert/strict";
import { test } from "node:test";
import { Proofs } from "../../src/proofs";

const ONE = "a.csp assert A terminates";
const OTHER = "a.csp assert B terminates";

test("a proof that ends with the server has no answer, and is known as interrupted until it is begun again", async () => {
  const proofs = new Proofs();
  let fail: (problem: Error) => void = () => undefined;
  const proof = proofs.during(ONE, () => new Promise((_, reject) => (fail = reject)));
  assert.equal(await proofs.during(OTHER, () => Promise.resolve("Proved")), "Proved");
  proofs.serverEnded();
  fail(new Error("Canceled"));
  assert.equal(await proof, undefined);
  assert.ok(proofs.wasInterrupted(ONE));
  assert.ok(!proofs.wasInterrupted(OTHER));
  await proofs.during(ONE, () => Promise.resolve(null));
  assert.ok(!proofs.wasInterrupted(ONE));
});

test("a proof that fails while the server runs fails", async () => {
  const proofs = new Proofs();
  await assert.rejects(proofs.during(ONE, () => Promise.reject(new Error("no such assertion"))), /no such assertion/);
  proofs.serverEnded();
  assert.ok(!proofs.wasInterrupted(ONE));
});
