/** The engine in a worker of this page. It computes one thing at a time, so what does not end is ended with the worker. */

import type { Connect, Reports } from "./engine";

/** Milliseconds in which a run stops; after that, its worker is ended. */
const PATIENCE = 3000;
const COMPUTES = `stopped: one of its processes has computed for ${PATIENCE / 1000} s without a communication, so the engine in this browser was started again`;
const CANCELLED = "stopped: the engine in this browser was started again to cancel what it computed";
/** Requests whose answers do not depend on what happened before: another worker answers them as well. */
const QUESTIONS = new Set(["hello", "check", "complete", "hover", "definition", "format", "explain", "draw", "verify", "timing", "margins", "compile", "run"]);
/** Those of them that `cancel` ends. */
const WORK = new Set(["verify", "timing", "margins", "compile", "run"]);

interface Message {
  id?: number;
  method?: string;
  params?: { session?: unknown };
  result?: { session?: unknown };
}

/** What the page needs of a worker. */
export interface Started {
  post: (message: object) => void;
  end: () => void;
}

export type Start = (on: Pick<Reports, "receive" | "lost">) => Started;

/** Answers `cancel`, and `stop` also of a program that never returns, as the server of the studio does. */
class BrowserEngine {
  private worker: Started;
  /** What the worker has not answered yet, in the order in which it was asked. */
  private readonly asked = new Map<number, Message>();
  /** The run that there is. */
  private session: unknown;
  private stopping: ReturnType<typeof setTimeout> | undefined;

  constructor(
    private readonly start: Start,
    private readonly on: Reports,
  ) {
    this.worker = this.started();
  }

  send(message: Message & { id: number }): void {
    if (message.method === "cancel") {
      this.again(CANCELLED, WORK);
      this.on.receive({ id: message.id, result: {} });
      return;
    }
    if (message.method === "stop") {
      this.stopping ??= setTimeout(() => this.again(COMPUTES), PATIENCE);
    }
    this.asked.set(message.id, message);
    this.worker.post(message);
  }

  private started(): Started {
    const { lost } = this.on;
    return this.start({ receive: (message) => this.receive(message as Message), lost });
  }

  private receive(message: Message): void {
    const question = this.asked.get(message.id ?? -1);
    this.asked.delete(message.id ?? -1);
    if (question?.method === "start" && message.result !== undefined) {
      this.session = message.result.session;
    }
    if (question?.method === "stop") {
      this.hasStopped();
    }
    if (message.method === "ended") {
      this.session = undefined;
    }
    this.on.receive(message);
  }

  private hasStopped(): void {
    clearTimeout(this.stopping);
    this.stopping = undefined;
  }

  /** Ends the worker with its run, and has another one answer the questions, but not the cancelled ones. */
  private again(why: string, cancelled: ReadonlySet<string> = new Set()): void {
    this.hasStopped();
    this.worker.end();
    this.worker = this.started();
    for (const [id, message] of [...this.asked]) {
      const { method = "" } = message;
      if (QUESTIONS.has(method) && !cancelled.has(method)) {
        this.worker.post(message);
        continue;
      }
      this.asked.delete(id);
      // Of a run nothing more is to be said than that it has ended.
      this.on.receive(cancelled.has(method) || method === "start" ? { id, error: { message: "cancelled" } } : { id, result: {} });
    }
    if (this.session !== undefined) {
      this.on.receive({ method: "ended", params: { session: this.session, at: null, reason: "stopped", text: why } });
      this.session = undefined;
    }
  }
}

export function inBrowser(start: Start): Connect {
  return (reports) => {
    const engine = new BrowserEngine(start, reports);
    return { send: (message) => engine.send(message as Message & { id: number }) };
  };
}

/**
 * The worker of this page. Made of a blob it has the content security policy of the page, which a file would not have:
 * programs may contain Python, and what they compute reaches nothing but this page.
 */
export const worker: Start = ({ receive, lost }) => {
  const script = new URL("worker.js", location.href).href;
  const address = URL.createObjectURL(new Blob([`import ${JSON.stringify(script)};`], { type: "text/javascript" }));
  const there = new Worker(address, { type: "module" });
  there.addEventListener("message", (event: MessageEvent<unknown>) => receive(event.data));
  there.addEventListener("error", (event) => {
    event.preventDefault();
    lost(event.message === "" ? "the engine in the browser is not part of this page" : event.message);
  });
  return {
    post: (message) => there.postMessage(message),
    end: () => there.terminate(),
  };
};
