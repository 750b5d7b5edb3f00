import assert from "node:assert/strict";
import { test } from "node:test";
import { Recording, innermost } from "../../src/run/recording";
import { Track, short } from "../../src/run/track";

const FRAME = { session: "1", from: 0, to: 100, signals: {} };

test("a track holds each value until the next", () => {
  const track = new Track();
  track.push([10, 20, 30], [1, null, 3]);
  assert.deepEqual([5, 10, 19, 25, 30, 99].map((at) => track.at(at)), [undefined, 1, 1, undefined, 3, 3]);
});

test("names and truth values are shown as they are", () => {
  const track = new Track();
  track.push([0, 1, 2], ["idle", "moving", "idle"]);
  assert.deepEqual([0, 1, 2].map((at) => track.textAt(at)), ["idle", "moving", "idle"]);
  assert.equal(track.textAt(-1), "–");
});

test("names have the order of their type, whatever comes first", () => {
  const recording = new Recording([{ name: "on", type: "bool" }, { name: "state", type: "State", literals: ["idle", "moving"] }]);
  recording.add({ ...FRAME, signals: { on: { t: [0, 1], v: [true, false] }, state: { t: [0], v: ["moving"] } } });
  assert.deepEqual([0, 1].map((at) => recording.tracks.get("on")?.textAt(at)), ["true", "false"]);
  assert.equal(recording.tracks.get("state")?.at(0), 1);
});

test("no peak is lost, however long the run", () => {
  const track = new Track();
  const times = Array.from({ length: 100_000 }, (_, i) => i);
  track.push(times, times.map((i) => (i === 54_321 ? 7 : 0)));
  assert.equal(Math.max(...track.columns(0, 100_000, 300).map((value) => value ?? 0)), 7);
});

test("columns show what held before them", () => {
  const track = new Track();
  track.push([0, 50], [1, 2]);
  assert.deepEqual(track.columns(20, 60, 4), [1, 1, 1, 1, 1, 2, 2, 2]);
});

test("of more than a million values the older half is forgotten, and the rest is right", () => {
  const track = new Track();
  const count = 1_100_000;
  for (let i = 0; i < count; i += 1000) {
    const times = Array.from({ length: 1000 }, (_, j) => i + j);
    track.push(times, times);
  }
  assert.ok(track.length <= 1_050_000);
  assert.equal(track.at(count - 1), count - 1);
  assert.equal(track.at(count - 400_000), count - 400_000);
  assert.equal(track.at(10), undefined);
  assert.equal(Math.max(...track.columns(count - 100_000, count, 10).map((value) => value ?? 0)), count - 1);
});

test("one can go back to what ran, waited and communicated", () => {
  const recording = new Recording([{ name: "x", type: "double" }]);
  recording.add({
    ...FRAME,
    signals: { x: { t: [0, 50], v: [1, 2] } },
    running: ["A.b"],
    communications: [{ t: 30, channel: "A.k" }, { t: 60, channel: "A.l" }],
    modes: [{ t: 0, group: "A", path: "A.one", mode: "one" }],
    waiting: [{ process: "A.c", channels: ["A.k"] }],
  });
  assert.deepEqual(recording.runningAt(99), []);
  assert.deepEqual(recording.runningAt(100), ["A.b"]);
  assert.deepEqual(recording.waitingAt(99), []);
  assert.equal(recording.waitingAt(100)[0]?.process, "A.c");
  assert.equal(recording.before(60), 30);
  assert.equal(recording.before(30), 0);
  assert.equal(recording.after(30), 60);
  assert.equal(recording.after(60), undefined);
  assert.equal(recording.modes.get("A")?.at(0, 49), "one");
});

test("of processes at work those are named that contain no other one", () => {
  assert.deepEqual(innermost(["Chatter", "Chatter.ping", "Chatter.pong", "Chatter.ping2"]), ["Chatter.ping", "Chatter.pong", "Chatter.ping2"]);
});

test("numbers are short", () => {
  assert.deepEqual([0, 3, 0.1 + 0.2, 1e-9, 123456.7, -2.5].map(short), ["0", "3", "0.3", "1.00e-9", "1.23e+5", "-2.5"]);
});
