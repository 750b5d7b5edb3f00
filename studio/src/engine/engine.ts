/** An engine: the compiler, the proofs and the runs, wherever they are. */

import type { Method, Notifications, Requests } from "./messages";

/** A request that an engine refused, in words for the user. */
export class EngineError extends Error {
  constructor(
    message: string,
    readonly help?: string,
  ) {
    super(message);
  }
}

/** What went wrong, and what to do. */
export function inWords(problem: unknown): string {
  if (problem instanceof EngineError && problem.help !== undefined) {
    return `${problem.message}: ${problem.help}`;
  }
  return problem instanceof Error ? problem.message : String(problem);
}

export interface Engine {
  request<M extends Method>(method: M, params: Requests[M]["params"]): Promise<Requests[M]["result"]>;
  on<N extends keyof Notifications>(name: N, listener: (params: Notifications[N]) => void): void;
}

/** How messages go to an engine. */
export interface Transport {
  send: (message: object) => void;
}

/** What a way to an engine reports. */
export interface Reports {
  /** A message that comes back. */
  receive: (message: unknown) => void;
  /** No message will come any more. */
  lost: (reason: string) => void;
  /** The other side does not answer for the time being, or answers again. */
  silent: (silent: boolean) => void;
}

export type Connect = (reports: Reports) => Transport;

interface Pending {
  resolve: (result: never) => void;
  reject: (reason: Error) => void;
}

interface Incoming {
  id?: number;
  result?: unknown;
  error?: { message: string; help?: string };
  method?: string;
  params?: unknown;
}

/** Requests and answers by their numbers, over any transport. */
export class Connection implements Engine {
  private readonly pending = new Map<number, Pending>();
  private readonly listeners = new Map<string, ((params: never) => void)[]>();
  private readonly transport: Transport;
  private last = 0;
  private gone: string | undefined;

  constructor(connect: Connect, on: Omit<Reports, "receive">) {
    this.transport = connect({
      receive: (message) => this.receive(message as Incoming),
      lost: (reason) => {
        this.gone = reason;
        for (const each of this.pending.values()) {
          each.reject(new EngineError(reason));
        }
        this.pending.clear();
        on.lost(reason);
      },
      silent: on.silent,
    });
  }

  request<M extends Method>(method: M, params: Requests[M]["params"]): Promise<Requests[M]["result"]> {
    if (this.gone !== undefined) {
      return Promise.reject(new EngineError(this.gone));
    }
    const id = ++this.last;
    return new Promise((resolve, reject) => {
      this.pending.set(id, { resolve, reject });
      this.transport.send({ id, method, params });
    });
  }

  on<N extends keyof Notifications>(name: N, listener: (params: Notifications[N]) => void): void {
    this.listeners.set(name, [...(this.listeners.get(name) ?? []), listener]);
  }

  private receive(message: Incoming): void {
    if (message.method !== undefined) {
      for (const listener of this.listeners.get(message.method) ?? []) {
        listener(message.params as never);
      }
      return;
    }
    const waiting = this.pending.get(message.id ?? -1);
    if (waiting === undefined) {
      return;
    }
    this.pending.delete(message.id ?? -1);
    if (message.error === undefined) {
      waiting.resolve(message.result as never);
    } else {
      waiting.reject(new EngineError(message.error.message, message.error.help));
    }
  }
}
