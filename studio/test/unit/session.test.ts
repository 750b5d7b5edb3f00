import assert from "node:assert/strict";
import { mock, test } from "node:test";
import { type Engine, EngineError } from "../../src/engine/engine";
import type { Frame } from "../../src/engine/messages";
import { Session } from "../../src/run/session";

const STARTED = { session: "1", signals: [], processes: [], channels: [] };

/** A session of an engine that answers at once, with the clock of the page; it refuses what `refuses` says. */
function made(refuses: (method: string) => void = () => undefined) {
  const clock = { now: 0 };
  mock.method(performance, "now", () => clock.now);
  const listeners = new Map<string, (params: object) => void>();
  let last: { target?: string } = {};
  const engine = {
    request: (method: string, params: { target?: string }) => {
      refuses(method);
      last = params;
      return Promise.resolve(method === "start" ? { ...STARTED, target: params.target } : {});
    },
    on: (name: string, listener: (params: object) => void) => listeners.set(name, listener),
  } as unknown as Engine;
  const session = new Session(engine);
  const tell = (name: string, params: object) => listeners.get(name)?.({ session: "1", ...params });
  const frame = (to: number, more: Partial<Frame> = {}) => tell("frame", { from: to, to, signals: {}, ...more });
  const end = (text: string) => tell("ended", { at: 0, reason: "fault", text });
  return { clock, session, frame, end, asked: () => last };
}

test("a run of which nothing arrives is said to be stalled, by its process or by the server", async () => {
  const { clock, session, frame } = made();
  await session.start({ files: {}, main: "" }, { real_time: false });
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
  await session.start({ files: {}, main: "" }, { real_time: false });
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

test("a run that fails before it is played says why, not that it has ended", async () => {
  const { session, end } = made((method) => {
    if (method === "play") {
      end("the driver keyboard failed to open");
      throw new EngineError("the run has ended", "start it again");
    }
  });
  await session.start({ files: {}, main: "" }, { real_time: true });
  await session.play(1);
  assert.equal(session.phase, "ended");
  assert.equal(session.ended?.text, "the driver keyboard failed to open");
  assert.equal(session.problem, "");
});

test("how a run ends hides neither a refused change nor is hidden by a refused request", async () => {
  const { session, frame, end } = made((method) => {
    if (method === "pause") {
      throw new EngineError("another page controls the program");
    }
  });
  await session.start({ files: {}, main: "" }, { real_time: false });
  await session.play(1);
  await session.pause();
  assert.equal(session.problem, "another page controls the program");
  frame(1, { refused: [{ parameter: "gain", text: "must be positive" }] });
  end("division by zero");
  assert.equal(session.problem, "");
  assert.equal(session.refused, "gain: must be positive");
});

test("a run says which code it is", async () => {
  const { session, asked } = made();
  assert.equal(session.target, "python");
  await session.start({ files: {}, main: "" }, { target: "c" });
  assert.equal(asked().target, "c");
  assert.equal(session.target, "c");
});

test("a run whose engine is gone has ended", async () => {
  const { clock, session } = made();
  await session.start({ files: {}, main: "" }, {});
  await session.play(1);
  session.lost();
  clock.now = 60_000;
  assert.equal(session.phase, "ended");
  assert.equal(session.stalled, undefined);
  assert.match(session.ended?.text ?? "", /its engine is gone/);
});

test("a page that watches looks back while the run goes on, and asks the engine for nothing", async () => {
  const asked: string[] = [];
  const { session, frame } = made((method) => asked.push(method));
  session.controls = false;
  await session.follow(STARTED);
  frame(2);
  frame(4);
  await session.pause();
  session.look(2);
  await session.step();
  frame(6);
  assert.equal(session.shown, 2);
  assert.equal(session.recording.now, 6);
  session.look(6);
  assert.equal(session.live, true);
  assert.equal(session.phase, "playing");
  await session.leave();
  assert.deepEqual(asked, []);
});
