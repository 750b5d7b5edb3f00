// An engine that knows one program, for tests of the page alone: what it answers is written here, hostile texts included.
//   node test/e2e/scripted.mjs [hostile]
import { createInterface } from "node:readline";

const HOSTILE = process.argv[2] === "hostile";
const EVIL = '<img src=x onerror="window.hacked=1"><script>window.hacked=1</script>';
const word = (plain) => (HOSTILE ? `${plain}${EVIL}` : plain);

const PROGRAM = { files: { "pair.csp": "process Pair {\n  left : A\n  right : B\n}\nassert Pair deadlock free\n" }, main: "pair.csp" };
const PICTURE = `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 200 100"><rect id="arm" x="90" y="20" width="20" height="60" data-rotate="speed * 90" data-centre="100 80"/><text x="10" y="20" data-text="speed" data-digits="1">0</text><script>window.hacked=1</script><circle r="5" onclick="window.hacked=1" data-x="axis * 50 + 100" data-colour="on" data-colours="0: #888888; 1: #00aa00"/><image href="https://example.org/x.png"/></svg>`;
const place = (line, from, to) => ({ file: "pair.csp", start: { line, character: from }, end: { line, character: to } });
const box = (id, x) =>
  `<g id="${id}"><title>${id}</title><rect class="fill-process stroke-border" x="${x}" y="20" width="80" height="40" rx="6"/><text class="fill-text" x="${x + 40}" y="44" text-anchor="middle" font-size="13">${id.slice(5)}</text></g>`;
const SVG = `<svg xmlns="http://www.w3.org/2000/svg" class="cspdiag" id="Pair" width="320" height="90" viewBox="0 0 320 90" role="group">${box("Pair-left", 20)}${box("Pair-right", 220)}<g id="Pair-token"><title>token</title><path class="stroke-line" fill="none" d="M100 40H220"/></g>${HOSTILE ? '<script>window.hacked=1</script><rect width="9" height="9" onload="window.hacked=1" onclick="window.hacked=1"/><a href="javascript:window.hacked=1"><text>x</text></a>' : ""}</svg>`;

const WAITING = [
  { process: "Pair.left", channels: ["Pair.token"], for: word("waits to write on token, for right") },
  { process: "Pair.right", channels: ["Pair.token"], for: word("waits to read from token, for left") },
];

let now = 0;
let playing;
let stick = 0;
let edited = 0;
const said = (message) => process.stdout.write(`${JSON.stringify(message)}\n`);
const MS = 1_000_000;

function frame(to) {
  const t = [];
  for (let at = now + MS; at <= to; at += MS) t.push(at);
  const from = now;
  now = to;
  said({
    method: "frame",
    params: {
      session: "1", from, to,
      signals: {
        axis: { t, v: t.map(() => stick) },
        speed: { t, v: t.map((at) => Math.sin(at / 2e8) + stick) },
        on: { t, v: t.map((at) => at % 4e8 < 2e8) },
      },
      communications: t.filter((at) => at % (50 * MS) === 0).map((at) => ({ t: at, channel: "Pair.token", writer: word("Pair.left"), reader: "Pair.right", value: HOSTILE ? EVIL : at / MS })),
      modes: from === 0 ? [{ t: 0, group: word("Pair"), path: "Pair.left", mode: word("align") }] : from < 500 * MS && to >= 500 * MS ? [{ t: 500 * MS, group: word("Pair"), path: "Pair.left", mode: null }, { t: 500 * MS, group: word("Pair"), path: "Pair.right", mode: "motion" }] : [],
      running: ["Pair.left", "Pair.right"], waiting: [],
    },
  });
  if (now >= 8000 * MS) end("deadlock", word("Deadlock: no process can continue."), WAITING);
}

function end(reason, text, waiting = []) {
  clearInterval(playing);
  said({ method: "ended", params: { session: "1", at: now, reason, text, waiting } });
}

const ANSWERS = {
  hello: () => ({ engine: "machine", version: word("0"), able: {}, targets: [word("c"), "python"], models: [{ name: "pair", title: word("A pair"), ...PROGRAM, files: { ...PROGRAM.files, "pair.svg": PICTURE } }] }),
  check: ({ files }) => {
    const text = files["pair.csp"];
    const wrong = /slip/.test(text);
    const line = text.split("\n").findIndex((each) => each.includes("slip"));
    edited += 1;
    return {
      diagnostics: wrong
        ? [{ severity: "error", code: "E0204", message: word("there is no value `slip`"), help: word("did you mean `left`?"), place: place(line, text.split("\n")[line].indexOf("slip"), text.split("\n")[line].indexOf("slip") + 4), related: [{ message: word("declared here"), place: place(1, 2, 6) }], fixes: [{ title: word("write left"), edits: [{ place: place(line, text.split("\n")[line].indexOf("slip"), text.split("\n")[line].indexOf("slip") + 4), text: "left" }] }] }]
        : [],
      top: "Pair",
      environments: [{ name: "Bench", inputs: [], outputs: [] }],
      processes: [],
      parameters: [{ name: word("gain"), type: "double", value: 2 }],
      assertions: [{ text: word("assert Pair deadlock free"), place: place(4, 0, 25) }],
      bodies: /python/.test(text) ? [{ language: "python", target: word("plant.py:Joint"), files: ["plant.py"] }] : [],
    };
  },
  complete: () => [{ label: word("left"), kind: "variable", detail: word("A"), documentation: word("The left one"), insert: "left" }],
  hover: () => ({ markdown: word("**left** : `A`") }),
  definition: () => [place(1, 2, 6)],
  format: ({ text }) => ({ text: text.replace(/ +:/g, " :") }),
  explain: ({ code }) => ({ title: word("an unknown name"), markdown: `${word("A name that is not declared.")}\n\n\`\`\`csp\nprocess X\n\`\`\`\n` }),
  draw: () => ({
    svg: SVG, of: "Pair", name: "Pair", definitions: ["Pair"],
    elements: [
      { id: "Pair-left", kind: "process", name: word("left"), path: "Pair.left", definition: "A", places: [place(1, 2, 10)] },
      { id: "Pair-right", kind: "process", name: "right", path: "Pair.right", definition: "B", places: [place(2, 2, 11)] },
      { id: "Pair-token", kind: "channel", name: "token", channels: ["Pair.token"], places: [] },
    ],
  }),
  verify: () => [
    {
      assertion: word("Pair deadlock free"), place: place(4, 0, 25), verdict: "fails", text: word("it can deadlock after 1 step"),
      suggestions: ["let right read first", "let left write first"].map((title) => ({ title: word(title), edits: [{ place: place(4, 0, 0), text: "// fixed\n" }] })),
      counterexample: { steps: [{ text: word("left writes 1 on token to right"), channel: "Pair.token", writer: "Pair.left", reader: "Pair.right", value: "1" }], final: { text: word("both wait for each other"), waiting: WAITING } },
    },
  ],
  compile: () => ({ files: { [word("pair/pair.c")]: word("int main(void);\n") } }),
  timing: () => ({ text: word("left  1 ms") }),
  start: () => {
    now = 0;
    stick = 0;
    return {
      session: "1", environment: "Bench",
      signals: [
        { name: "axis", direction: "in", type: "double", hand: true },
        { name: "speed", direction: "out", type: "double<rad/s>", unit: "rad/s", hand: false },
        { name: "on", direction: "out", type: "bool", hand: false },
      ],
      processes: [], channels: ["Pair.token"], parameters: [],
    };
  },
  play: ({ speed }) => {
    clearInterval(playing);
    playing = setInterval(() => frame(now + 20 * speed * MS), 20);
    return {};
  },
  pause: () => (clearInterval(playing), { now }),
  stop: () => (end("stopped", "stopped by hand"), { now }),
  step: () => (frame(now + 50 * MS), { now }),
  input: ({ value }) => ((stick = value ?? 0), {}),
  tune: () => ({}),
  state: () => ({ now, running: [], waiting: WAITING }),
};

createInterface({ input: process.stdin }).on("line", (line) => {
  const { id, method, params } = JSON.parse(line);
  const answer = ANSWERS[method];
  said(answer === undefined ? { id, error: { message: `there is no ${method}` } } : { id, result: answer(params) });
});
