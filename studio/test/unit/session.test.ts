import assert from "node:assert/strict";
import { mock, test } from "node:test";
import type { Engine } from "../../src/engine/engine";
import type { Frame } from "../../src/engine/messages";
import { Session } from "../../src/run/session";

const STARTED = { session: "1", signals: [], processes: [], channels: [] };

/** A session of an engine that answers at once, with the clock of the page. */
function made() {
  const clock = { now: 0 };
  mock.method(performance, "now", () => clock.now);
  let show: (frame: Frame) => void = () => undefined;
  const engine = {
    request: (method: string) => Promise.resolve(method === "start" ? STARTED : {}),
    on: (name: string, listener: typeof show) => (show = name === "frame" ? listener : show),
  } as unknown as Engine;
  const session = new Session(engine);
  return { clock, session, frame: (to: number) => show({ session: "1", from: to, to, signals: {} }) };
}

test("a run of which nothing arrives is said to be stalled, by its process or by the server", async () => {
  const { clock, session, frame } = made();
  await session.start({ files: {}, main: "" }, "", "", false);
  await session.play(1);
  clock.now = 2500;
  frame(1);
  clock.now = 5000;
  assert.equal(session.stalled, undefined);
  clock.now = 6000;
  assert.equal(session.stalled, "process");
  session.silent(true);
  assert.equal(session.stalled, "server");
  session.silent(false);
  assert.equal(session.stalled, undefined);
  clock.now = 12_000;
  assert.equal(session.stalled, "process");
  await session.pause();
  assert.equal(session.stalled, undefined);
});

test("time stands still as long as the run plays", async () => {
  const { clock, session, frame } = made();
  await session.start({ files: {}, main: "" }, "", "", false);
  await session.play(0);
  clock.now = 2500;
  frame(0);
  assert.equal(session.standsStill, true);
  await session.pause();
  assert.equal(session.standsStill, false);
  frame(0);
  assert.equal(session.standsStill, false);
});

test("a run of another page, which may have paused it, is not said to be stalled", async () => {
  const { clock, session } = made();
  await session.follow(STARTED);
  clock.now = 60_000;
  assert.equal(session.stalled, undefined);
});
