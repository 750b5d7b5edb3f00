import assert from "node:assert/strict";
import { mock, test } from "node:test";
import { inBrowser } from "../../src/engine/browser";

interface Message {
  id?: number;
  method?: string;
  result?: unknown;
  error?: unknown;
  params?: unknown;
}

/** The engine with workers that answer nothing by themselves: what each was asked, and what the page hears. */
function made() {
  const workers: { asked: Message[]; ended: boolean; answer: (message: Message) => void }[] = [];
  const heard: Message[] = [];
  const connect = inBrowser(({ receive }) => {
    const worker = { asked: [] as Message[], ended: false, answer: receive };
    workers.push(worker);
    return { post: (message) => worker.asked.push(message), end: () => (worker.ended = true) };
  });
  const engine = connect({ receive: (message) => heard.push(message as Message), lost: () => assert.fail(), silent: () => assert.fail() });
  engine.send({ id: 1, method: "start", params: {} });
  workers[0]?.answer({ id: 1, result: { session: 7 } });
  return { engine, workers, heard };
}

test("a run that does not stop is ended with its worker, and another one answers the questions", () => {
  mock.timers.enable({ apis: ["setTimeout"] });
  const { engine, workers, heard } = made();
  engine.send({ id: 2, method: "play", params: { session: 7 } });
  engine.send({ id: 3, method: "check", params: {} });
  engine.send({ id: 4, method: "stop", params: { session: 7 } });
  mock.timers.tick(2999);
  assert.equal(workers.length, 1);
  mock.timers.tick(1);
  assert.equal(workers[0]?.ended, true);
  assert.deepEqual(workers[1]?.asked.map(({ id }) => id), [3]);
  assert.deepEqual(heard.slice(1, 3), [{ id: 2, result: {} }, { id: 4, result: {} }]);
  assert.match(JSON.stringify(heard[3]), /"method":"ended".*"session":7,.*"reason":"stopped".*without a communication/);
  workers[1].answer({ id: 3, result: "checked" });
  assert.deepEqual(heard.at(-1), { id: 3, result: "checked" });
  mock.timers.reset();
});

test("a run that stops leaves its worker alone", () => {
  mock.timers.enable({ apis: ["setTimeout"] });
  const { engine, workers } = made();
  engine.send({ id: 2, method: "stop", params: { session: 7 } });
  workers[0]?.answer({ id: 2, result: { now: 5 } });
  mock.timers.tick(60_000);
  assert.equal(workers.length, 1);
  mock.timers.reset();
});

test("proofs are cancelled, with the run that waits for them", () => {
  const { engine, workers, heard } = made();
  engine.send({ id: 2, method: "verify", params: {} });
  engine.send({ id: 3, method: "draw", params: {} });
  engine.send({ id: 4, method: "cancel", params: {} });
  assert.deepEqual(heard[1], { id: 2, error: { message: "cancelled" } });
  assert.deepEqual(heard.slice(2).map(({ id, method }) => id ?? method), ["ended", 4]);
  assert.deepEqual(workers[1]?.asked.map(({ id }) => id), [3]);
});
