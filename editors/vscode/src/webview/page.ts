/** The page of the diagram: shows the picture, and says what is done with it. */

import type { FromPage, PagePart, ToPage, Which } from "../messages";

declare function acquireVsCodeApi(): { postMessage: (message: FromPage) => void };

const api = acquireVsCodeApi();
const STEP = 1.2;

function element<T extends HTMLElement>(id: string, type: new () => T): T {
  const found = document.getElementById(id);
  if (!(found instanceof type)) {
    throw new Error(`the page has no ${id}`);
  }
  return found;
}

const picture = element("picture", HTMLElement);
const process = element("process", HTMLSelectElement);
const which = element("which", HTMLSelectElement);
const status = element("status", HTMLParagraphElement);
const steps = element("steps", HTMLElement);

let parts: Record<string, PagePart> = {};
let svg: SVGSVGElement | undefined;
/** Undefined while the picture is as wide as the page. */
let scale: number | undefined;

function show(message: Extract<ToPage, { type: "picture" }>): void {
  const parsed = new DOMParser().parseFromString(message.svg, "image/svg+xml").documentElement;
  if (!(parsed instanceof SVGSVGElement)) {
    return;
  }
  const focused = document.activeElement?.id ?? "";
  parts = message.parts;
  svg = document.importNode(parsed, true);
  picture.replaceChildren(svg);
  for (const id of Object.keys(parts)) {
    const group = svg.getElementById(id);
    group.setAttribute("tabindex", "0");
    group.setAttribute("role", "button");
    group.setAttribute("aria-label", group.querySelector(":scope > title")?.textContent.replaceAll("\n", ", ") ?? id);
  }
  const named = message.processes.map((name) => new Option(name, name));
  process.replaceChildren(new Option("At the cursor", ""), ...named);
  process.value = message.name;
  resize();
  const again = focused === "" ? null : svg.querySelector<SVGElement>(`#${CSS.escape(focused)}`);
  again?.focus({ preventScroll: true });
}

function natural(): { width: number; height: number } {
  const box = svg?.viewBox.baseVal;
  return { width: box?.width ?? 1, height: box?.height ?? 1 };
}

function present(): number {
  return scale ?? Math.min(1, picture.clientWidth / natural().width);
}

function resize(): void {
  const { width, height } = natural();
  svg?.setAttribute("width", String(width * present()));
  svg?.setAttribute("height", String(height * present()));
}

/** Changes the size, and keeps a point of the window in its place. */
function zoom(factor: number, x = picture.clientWidth / 2, y = picture.clientHeight / 2): void {
  const before = present();
  scale = Math.min(8, Math.max(0.1, before * factor));
  const change = scale / before;
  const [left, top] = [(picture.scrollLeft + x) * change - x, (picture.scrollTop + y) * change - y];
  resize();
  picture.scrollTo(left, top);
}

function fit(): void {
  scale = undefined;
  resize();
}

function mark(name: string, ids: readonly string[]): SVGElement[] {
  for (const each of picture.querySelectorAll(`.${name}`)) {
    each.classList.remove(name);
  }
  const found = ids.flatMap((id) => [...picture.querySelectorAll<SVGElement>(`#${CSS.escape(id)}`)]);
  for (const each of found) {
    each.classList.add(name);
  }
  return found;
}

function reveal(found: readonly SVGElement[]): void {
  found[0]?.scrollIntoView({ block: "nearest", inline: "nearest" });
}

function receive(message: ToPage): void {
  switch (message.type) {
    case "picture":
      show(message);
      break;
    case "status":
      status.hidden = message.text === "";
      status.textContent = message.text;
      picture.classList.toggle("stale", message.stale);
      break;
    case "lit": {
      const found = mark("lit", message.ids);
      if (message.reveal) {
        reveal(found);
      }
      break;
    }
    case "step":
      steps.hidden = message.text === "";
      element("step", HTMLSpanElement).textContent = message.text;
      element("position", HTMLOutputElement).textContent = message.position;
      reveal([...mark("communicating", message.communicating), ...mark("waiting", message.waiting)]);
      break;
  }
}

/** The element of the diagram in which something happened. */
function partOf(event: Event): string | undefined {
  let at = event.target instanceof Element ? event.target : null;
  while (at !== null && !(at.id in parts)) {
    at = at.parentElement;
  }
  return at?.id;
}

window.addEventListener("message", (event: MessageEvent<ToPage>) => {
  receive(event.data);
});
window.addEventListener("resize", resize);
process.addEventListener("change", () => {
  api.postMessage({ type: "process", name: process.value });
});
which.addEventListener("change", () => {
  api.postMessage({ type: "which", which: which.value as Which });
});

const ACTIONS: Record<string, () => void> = {
  smaller: () => {
    zoom(1 / STEP);
  },
  larger: () => {
    zoom(STEP);
  },
  fit,
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

picture.addEventListener("click", (event) => {
  const id = partOf(event);
  if (id !== undefined && !dragged) {
    api.postMessage({ type: "source", id });
  }
});
picture.addEventListener("dblclick", (event) => {
  const id = partOf(event);
  if (id !== undefined && parts[id]?.opens === true) {
    api.postMessage({ type: "inside", id });
  }
});

const KEYS: Record<string, () => void> = {
  "+": ACTIONS["larger"] ?? fit,
  "=": ACTIONS["larger"] ?? fit,
  "-": ACTIONS["smaller"] ?? fit,
  "0": fit,
};
picture.addEventListener("keydown", (event) => {
  const id = partOf(event);
  if ((event.key === "Enter" || event.key === " ") && id !== undefined) {
    api.postMessage({ type: event.shiftKey && parts[id]?.opens === true ? "inside" : "source", id });
    event.preventDefault();
  } else if (!event.ctrlKey && !event.metaKey && event.key in KEYS) {
    KEYS[event.key]?.();
    event.preventDefault();
  }
});
picture.addEventListener(
  "wheel",
  (event) => {
    if (event.ctrlKey || event.metaKey) {
      const room = picture.getBoundingClientRect();
      zoom(Math.exp(-event.deltaY / 300), event.clientX - room.left, event.clientY - room.top);
      event.preventDefault();
    }
  },
  { passive: false },
);

/** Whether the pointer was moved while it was down: then it was no click. */
let dragged = false;
picture.addEventListener("pointerdown", (down) => {
  dragged = false;
  const [left, top] = [picture.scrollLeft, picture.scrollTop];
  const move = (event: PointerEvent) => {
    const [dx, dy] = [event.clientX - down.clientX, event.clientY - down.clientY];
    dragged ||= Math.hypot(dx, dy) > 4;
    if (dragged) {
      picture.scrollTo(left - dx, top - dy);
    }
  };
  window.addEventListener("pointermove", move);
  window.addEventListener(
    "pointerup",
    () => {
      window.removeEventListener("pointermove", move);
    },
    { once: true },
  );
});

api.postMessage({ type: "ready" });
