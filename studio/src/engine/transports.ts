/** The two ways to an engine: a worker of this page, and a WebSocket of the machine that served it. */

import { inBrowser, worker } from "./browser";
import type { Connect } from "./engine";
import { Pings } from "./pings";

/** What the page has not seen waits at the server, which sends no more than a page can show. */
const SEEN = JSON.stringify({ method: "seen" });
const PING = JSON.stringify({ method: "ping" });
/** Milliseconds between two pings. */
const BETWEEN = 1000;

const REFUSED = "the server has ended, or it is another one than that of this link: open the link that `cspdiag studio` has shown last";

export function socket(token: string): Connect {
  return ({ receive, lost, silent }) => {
    const url = new URL(`engine?token=${encodeURIComponent(token)}`, location.href);
    url.protocol = url.protocol === "https:" ? "wss:" : "ws:";
    url.hash = "";
    const there = new WebSocket(url);
    const early: string[] = [];
    let opened = false;
    const pings = new Pings(() => there.send(PING), silent);
    let pinging: ReturnType<typeof setInterval> | undefined;
    there.addEventListener("open", () => {
      opened = true;
      pinging = setInterval(() => pings.tick(performance.now()), BETWEEN);
      for (const message of early.splice(0)) {
        there.send(message);
      }
    });
    there.addEventListener("message", (event: MessageEvent<string>) => {
      pings.heard();
      const message = JSON.parse(event.data) as { method?: string };
      receive(message);
      if (message.method === "frame") {
        there.send(SEEN);
      }
    });
    there.addEventListener("close", (event) => {
      clearInterval(pinging);
      pings.heard();
      const why = opened ? "the engine has ended, or the connection to it is lost" : REFUSED;
      lost(event.reason === "" ? why : event.reason);
    });
    return {
      send: (message) => {
        const text = JSON.stringify(message);
        if (there.readyState === WebSocket.CONNECTING) {
          early.push(text);
        } else {
          there.send(text);
        }
      },
    };
  };
}

/** The way that the address of this page asks for. */
export function chosen(): Connect {
  const token = new URLSearchParams(location.search).get("token");
  return token === null ? inBrowser(worker) : socket(token);
}
