/** What the page and an engine say to each other; docs/design/studio.md is the reference. Times are nanoseconds. */

export interface Position {
  line: number;
  character: number;
}

/** A range of a file, as the Language Server Protocol counts it: from zero, in UTF-16. */
export interface Place {
  file: string;
  start: Position;
  end: Position;
}

export interface Program {
  files: Record<string, string>;
  main: string;
}

export interface Model extends Program {
  name: string;
  title: string;
}

export interface Edit {
  place: Place;
  text: string;
}

export interface Fix {
  title: string;
  edits: Edit[];
}

export interface Finding {
  severity: string;
  code: string | null;
  message: string;
  help?: string | null;
  place: Place | null;
  related: { message: string; place: Place }[];
  fixes: Fix[];
}

export interface EnvironmentInfo {
  name: string;
  inputs: string[];
  outputs: string[];
  /** With the languages in which they are written; a device of cspdiag is in another one than C. */
  drivers?: { name: string; language: string }[];
}

export interface Field {
  name: string;
  type: string;
  unit?: string | null;
  /** Of an enum: the names of its values. */
  literals?: string[] | null;
  value: unknown;
}

export interface ParameterInfo extends Field {
  /** The numbers that it consists of, under the names by which they are changed. */
  fields?: Field[] | null;
  doc?: string | null;
  place?: Place | null;
}

export interface Assertion {
  text: string;
  place: Place;
}

export interface CheckResult {
  diagnostics: Finding[];
  top?: string | null;
  environments: EnvironmentInfo[];
  processes: { path: string; name: string; place: Place }[];
  parameters: ParameterInfo[];
  assertions: Assertion[];
  bodies: Body[];
}

/** A part of a program in another language, or a device. */
export interface Body {
  language: string;
  target: string;
  /** None of installed modules and devices; those that the program does not have are on the machine. */
  files: string[];
}

export interface CompletionItem {
  label: string;
  kind: string;
  detail?: string | null;
  documentation?: string | null;
  insert?: string | null;
  start?: Position | null;
  end?: Position | null;
}

export interface DrawnElement {
  id: string;
  kind: string;
  name: string;
  places?: Place[];
  /** Of a process: as runs name it. */
  path?: string | null;
  /** Of a process: what it is an instance of. */
  definition?: string | null;
  /** Of ports, channels and stores: the channels of runs that it stands for. */
  channels?: string[] | null;
}

export interface DrawResult {
  svg: string;
  elements: DrawnElement[];
  /** What is drawn: a definition, or the path of an instance. */
  of: string;
  /** The definition that is drawn. */
  name: string;
  definitions: string[];
}

export interface Waiting {
  process: string;
  channels: string[];
  for?: string | null;
  /** The processes that it waits for. */
  partners?: string[] | null;
  /** Why it waits forever, as the end of the sentence, if no process is at the other side. */
  why?: string;
}

export interface Step {
  kind?: string;
  time?: number | null;
  text: string;
  channel?: string | null;
  writer?: string | null;
  reader?: string | null;
  value?: unknown;
  waiting?: Waiting[] | null;
}

export interface Counterexample {
  steps: Step[];
  /** What can be repeated forever after them. */
  cycle?: Step[] | null;
  final?: unknown;
}

export interface Suggestion extends Fix {
  /** A setting of a constant, if it was proved for that only. */
  proved_with?: string | null;
}

export interface Answer {
  assertion: string;
  place?: Place | null;
  verdict: string;
  text: string;
  /** Each of them, alone, makes the assertion hold. */
  suggestions?: Suggestion[];
  counterexample?: Counterexample | null;
}

export interface Signal {
  name: string;
  direction: string;
  type: string;
  unit?: string | null;
  literals?: string[] | null;
  /** Whether a hand may take it over. */
  hand: boolean;
}

/** Engines count runs. */
export type SessionId = number | string;

/** What a run is begun with. */
export interface Chosen {
  environment?: string | undefined;
  /** Values of parameters, as they are changed during a run. */
  set?: Record<string, Value>;
  /** The recording whose inputs it gets. */
  inputs?: string | undefined;
  real_time?: boolean;
  target?: string;
  /** Whether it is the program of the files with which the studio was started, for the other pages. */
  own?: boolean;
}

export interface StartResult {
  session: SessionId;
  environment?: string | null;
  signals: Signal[];
  processes: { path: string; name: string }[];
  channels: unknown[];
  parameters?: ParameterInfo[] | null;
  until?: number | null;
  /** Whether it keeps pace with the clock, and cannot be paused. */
  real_time?: boolean | null;
  /** The language of the code that runs: python or c. */
  target?: string | null;
}

export interface Communication {
  t: number;
  channel: string;
  writer?: string | null;
  reader?: string | null;
  value?: unknown;
}

export interface Mode {
  t: number;
  /** The part of the program whose mode it is. */
  group: string;
  path: string;
  /** Null: the process has ended, and no other has begun. */
  mode: string | null;
}

export type Value = number | boolean | string | null;

export interface Frame {
  session: SessionId;
  from: number;
  to: number;
  signals: Record<string, { t: number[]; v: Value[] }>;
  communications?: Communication[];
  omitted?: number | null;
  modes?: Mode[];
  /** The processes that run at its end. */
  running?: string[];
  /** Changes of parameters that the program did not accept. */
  refused?: { parameter: string; text: string }[];
  waiting?: Waiting[];
  /** How many samples of inputs were missed until now. */
  missed?: Record<string, number>;
}

export interface Ended {
  session: SessionId;
  at: number | null;
  reason: string;
  text: string;
  waiting?: Waiting[] | null;
}

/** A run that another page controls. */
export interface Running extends Program, StartResult {
  own?: boolean;
}

export interface HandState {
  /** Whether this page controls the program. */
  hand: boolean;
  /** The number of this page, and of the one that controls the program. */
  page: number;
  held_by: number | null;
  viewers: number;
}

export interface Hello extends Partial<HandState> {
  engine: string;
  version: string;
  able?: Record<string, boolean>;
  /** Why it is not able to do something of that. */
  unable?: Record<string, string>;
  models: Model[];
  program?: Program | null;
  /** Files beside the program whose inputs a run can have. */
  recordings?: string[];
  targets?: string[];
  running?: Running | null;
}

type At = { place: { file: string } & Position } & Program;

/** Parameters and result of each request. */
export interface Requests {
  hello: { params: Record<string, never>; result: Hello };
  check: { params: Program; result: CheckResult };
  complete: { params: At; result: CompletionItem[] };
  hover: { params: At; result: { markdown: string; place?: Place | null } | null };
  definition: { params: At; result: Place[] };
  format: { params: { text: string }; result: { text: string } };
  draw: { params: Program & { view: string; of?: string; depth?: number }; result: DrawResult };
  explain: { params: { code: string }; result: { title: string; markdown: string } };
  verify: { params: Program & { only?: string }; result: Answer[] };
  timing: { params: Program; result: { text: string } };
  margins: { params: Program & { environment?: string | undefined }; result: { text: string } };
  cancel: { params: Record<string, never>; result: unknown };
  take_hand: { params: Record<string, never>; result: unknown };
  save: { params: { file: string; text: string; before: string }; result: unknown };
  compile: { params: Program & { target: string; level?: number }; result: { files: Record<string, string> } };
  start: {
    params: Program & Chosen;
    result: StartResult;
  };
  play: { params: { session: SessionId; speed: number }; result: unknown };
  pause: { params: { session: SessionId }; result: { now: number } };
  stop: { params: { session: SessionId }; result: unknown };
  step: { params: { session: SessionId; by: "communication" | "instant"; count?: number }; result: { now: number } };
  input: { params: { session: SessionId; name: string; value: Value }; result: unknown };
  tune: { params: { session: SessionId; name: string; value: unknown }; result: unknown };
  state: { params: { session: SessionId }; result: { now: number; playing: boolean; running: string[]; waiting: Waiting[] } };
}

export type Method = keyof Requests;

export interface Notifications {
  frame: Frame;
  ended: Ended;
  log: { text: string };
  hand: HandState;
  started: Running;
  /** The program of the engine, whose files somebody has changed. */
  on_disk: Program;
  starting: { doing: string };
  ready: Record<string, never>;
}
