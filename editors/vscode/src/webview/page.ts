/** The page of the diagram: shows the picture, and says what is done with it. */

import type { Chosen, FromPage, ToPage, Which } from "../messages";
import { Picture } from "./picture";

declare function acquireVsCodeApi(): { postMessage: (message: FromPage) => void; setState: (state: Chosen) => void };

const api = acquireVsCodeApi();

function element<T extends HTMLElement>(id: string, type: new () => T): T {
  const found = document.getElementById(id);
  if (!(found instanceof type)) {
    throw new Error(`the page has no ${id}`);
  }
  return found;
}

const room = element("picture", HTMLElement);
const process = element("process", HTMLSelectElement);
const which = element("which", HTMLSelectElement);
const status = element("status", HTMLParagraphElement);
const steps = element("steps", HTMLElement);
const picture = new Picture(room, {
  source: (id) => {
    api.postMessage({ type: "source", id });
  },
  inside: (id) => {
    api.postMessage({ type: "inside", id });
  },
});

function show(message: Extract<ToPage, { type: "picture" }>): void {
  if (!picture.show(message.svg, message.parts)) {
    return;
  }
  const named = message.processes.map((name) => new Option(name, name));
  process.replaceChildren(new Option("At the cursor", ""), ...named);
  process.value = message.chosen.process ?? "";
  which.value = message.chosen.which;
  api.setState(message.chosen);
}

function receive(message: ToPage): void {
  switch (message.type) {
    case "picture":
      show(message);
      break;
    case "status":
      status.hidden = message.text === "";
      status.textContent = message.text;
      room.classList.toggle("stale", message.stale);
      break;
    case "lit": {
      const found = picture.mark("lit", message.ids);
      if (message.reveal) {
        picture.reveal(found);
      }
      break;
    }
    case "step":
      steps.hidden = message.text === "";
      element("step", HTMLSpanElement).textContent = message.text;
      element("position", HTMLOutputElement).textContent = message.position;
      // Without disabling them, which would take the keyboard away from the one that was pressed.
      element("previous", HTMLButtonElement).ariaDisabled = String(message.isFirst);
      element("next", HTMLButtonElement).ariaDisabled = String(message.isLast);
      picture.reveal([...picture.mark("communicating", message.communicating), ...picture.mark("waiting", message.waiting)]);
      break;
  }
}

window.addEventListener("message", (event: MessageEvent<ToPage>) => {
  receive(event.data);
});
process.addEventListener("change", () => {
  api.postMessage({ type: "process", name: process.value });
});
which.addEventListener("change", () => {
  api.postMessage({ type: "which", which: which.value as Which });
});

const ACTIONS: Record<string, () => void> = {
  smaller: () => {
    picture.smaller();
  },
  larger: () => {
    picture.larger();
  },
  fit: () => {
    picture.fit();
  },
  export: () => {
    api.postMessage({ type: "export" });
  },
  previous: () => {
    api.postMessage({ type: "move", by: -1 });
  },
  next: () => {
    api.postMessage({ type: "move", by: 1 });
  },
  leave: () => {
    api.postMessage({ type: "leave" });
  },
};
for (const [id, act] of Object.entries(ACTIONS)) {
  element(id, HTMLButtonElement).addEventListener("click", act);
}

api.postMessage({ type: "ready" });
