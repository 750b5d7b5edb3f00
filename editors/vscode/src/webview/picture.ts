/** A diagram that can be moved, enlarged, marked and used by keyboard; the page of the studio has it, too. */

/** What is known of an element of the diagram. */
export interface Part {
  /** Whether its inside has a diagram of its own. */
  opens: boolean;
}

export interface Actions {
  /** An element was clicked, or chosen by Enter. */
  source: (id: string) => void;
  /** The inside of an element is wanted: it was clicked twice, or chosen by Shift and Enter. */
  inside: (id: string) => void;
}

const STEP = 1.2;
/** How much a small diagram is enlarged where there is room. */
const LARGEST = 1.4;
/** In a room that is narrower than this, in pixels, a diagram is shown at least so large that it can be read. */
const [NARROW, LEGIBLE] = [500, 0.8];
/** As small as this a whole diagram is still preferred to a part of it. */
const SMALLEST = 0.6;
const ACTIVE = /^(?:script|foreignObject|iframe|object|embed|animate|set|animateTransform|animateMotion|use|image)$/i;

/** Whether CSS may fetch something: it refers to anything but parts of its picture, or has escapes, by which it could. */
export function fetches(css: string): boolean {
  const others = css.replace(/url\(\s*(["']?)#[^"')\\]*\1\s*\)/gi, "");
  return /@import|(?:url|src|image|image-set)\s*\(|\\[^(]*\(/i.test(others);
}

/** An SVG from a text, without anything that could act or fetch; undefined if the text is not one. */
export function safe(text: string): SVGSVGElement | undefined {
  const parsed = new DOMParser().parseFromString(text, "image/svg+xml").documentElement;
  if (!(parsed instanceof SVGSVGElement)) {
    return undefined;
  }
  for (const each of [parsed, ...parsed.querySelectorAll("*")]) {
    if (ACTIVE.test(each.localName) || !(each instanceof SVGElement)) {
      each.remove();
      continue;
    }
    if (each.localName === "style" && fetches(each.textContent)) {
      each.remove();
    }
    for (const { name, value } of [...each.attributes]) {
      const refers = /(?:^|:)href$/i.test(name) && !value.trim().startsWith("#");
      if (/^on/i.test(name) || refers || fetches(value) || /javascript:/i.test(value)) {
        each.removeAttribute(name);
      }
    }
  }
  return document.importNode(parsed, true);
}

export class Picture {
  private parts: Record<string, Part> = {};
  private svg: SVGSVGElement | undefined;
  /** Undefined while the picture is as large as its room allows. */
  private scale: number | undefined;
  /** Whether the whole diagram is wanted, legible or not. */
  private whole = false;
  /** Whether the pointer was moved while it was down: then it was no click. */
  private dragged = false;
  private readonly pointers = new Map<number, PointerEvent>();

  constructor(
    private readonly room: HTMLElement,
    private readonly actions: Actions,
  ) {
    window.addEventListener("resize", () => {
      this.resize();
    });
    room.addEventListener("click", (event) => {
      const id = this.partOf(event);
      if (id !== undefined && !this.dragged) {
        actions.source(id);
      }
    });
    room.addEventListener("dblclick", (event) => {
      const id = this.partOf(event);
      if (id !== undefined && this.parts[id]?.opens === true) {
        actions.inside(id);
      }
    });
    room.addEventListener("keydown", (event) => {
      this.key(event);
    });
    room.addEventListener(
      "wheel",
      (event) => {
        if (event.ctrlKey || event.metaKey) {
          this.zoomAt(Math.exp(-event.deltaY / 300), event);
          event.preventDefault();
        }
      },
      { passive: false },
    );
    room.addEventListener("pointerdown", (event) => {
      this.drag(event);
    });
  }

  /** Shows a diagram in place of the one before; the keyboard stays where it was, or at the first part if that is gone.
   * Returns whether it could be read. */
  show(text: string, parts: Record<string, Part>): boolean {
    const read = safe(text);
    if (read === undefined) {
      return false;
    }
    const focused = this.room.contains(document.activeElement) ? (document.activeElement?.id ?? "") : "";
    this.parts = parts;
    this.svg = read;
    this.room.replaceChildren(read);
    for (const id of Object.keys(parts)) {
      const group = read.querySelector(`#${CSS.escape(id)}`);
      group?.setAttribute("tabindex", "0");
      group?.setAttribute("role", "button");
      group?.setAttribute("aria-label", group.querySelector(":scope > title")?.textContent.replaceAll("\n", ", ") ?? id);
    }
    this.resize();
    const again = focused === "" ? null : read.querySelector<SVGElement>(`#${CSS.escape(focused)}`) ?? read.querySelector<SVGElement>("[tabindex]");
    again?.focus({ preventScroll: true });
    return true;
  }

  larger(): void {
    this.zoom(STEP);
  }

  smaller(): void {
    this.zoom(1 / STEP);
  }

  /** As large as its room allows. */
  fit(): void {
    this.whole = true;
    this.scale = undefined;
    this.resize();
  }

  /** Gives a class to these elements and to no others; returns them. */
  mark(name: string, ids: Iterable<string>): SVGElement[] {
    const found = [...ids].flatMap((id) => [...this.room.querySelectorAll<SVGElement>(`#${CSS.escape(id)}`)]);
    const wanted = new Set<Element>(found);
    for (const each of this.room.querySelectorAll(`.${name}`)) {
      if (!wanted.has(each)) {
        each.classList.remove(name);
      }
    }
    for (const each of found) {
      each.classList.add(name);
    }
    return found;
  }

  reveal(found: readonly SVGElement[]): void {
    found[0]?.scrollIntoView({ block: "nearest", inline: "nearest" });
  }

  private revealFocused(): void {
    const focused = document.activeElement;
    if (focused instanceof SVGElement && this.room.contains(focused)) {
      this.reveal([focused]);
    }
  }

  resize(): void {
    const { width, height } = this.natural();
    this.svg?.setAttribute("width", String(width * this.present()));
    this.svg?.setAttribute("height", String(height * this.present()));
  }

  private natural(): { width: number; height: number } {
    const box = this.svg?.viewBox.baseVal;
    return { width: box?.width ?? 1, height: box?.height ?? 1 };
  }

  private present(): number {
    if (this.scale !== undefined) {
      return this.scale;
    }
    const { width, height } = this.natural();
    const wide = this.room.clientWidth / width;
    const all = Math.min(wide, this.room.clientHeight / height, LARGEST);
    if (this.whole) {
      return all;
    }
    if (this.room.clientWidth < NARROW) {
      return Math.min(Math.max(wide, LEGIBLE), 1);
    }
    return Math.max(all, Math.min(wide, SMALLEST));
  }

  /** Changes the size, and keeps a point of the window in its place. */
  private zoom(factor: number, x = this.room.clientWidth / 2, y = this.room.clientHeight / 2): void {
    const before = this.present();
    this.scale = Math.min(8, Math.max(0.1, before * factor));
    const change = this.scale / before;
    const [left, top] = [(this.room.scrollLeft + x) * change - x, (this.room.scrollTop + y) * change - y];
    this.resize();
    this.room.scrollTo(left, top);
  }

  private zoomAt(factor: number, point: { clientX: number; clientY: number }): void {
    const room = this.room.getBoundingClientRect();
    this.zoom(factor, point.clientX - room.left, point.clientY - room.top);
  }

  /** The element of the diagram in which something happened. */
  private partOf(event: Event): string | undefined {
    let at = event.target instanceof Element ? event.target : null;
    while (at !== null && !Object.hasOwn(this.parts, at.id)) {
      at = at.parentElement;
    }
    return at?.id;
  }

  private key(event: KeyboardEvent): void {
    const id = this.partOf(event);
    if ((event.key === "Enter" || event.key === " ") && id !== undefined) {
      if (event.shiftKey && this.parts[id]?.opens === true) {
        this.actions.inside(id);
      } else {
        this.actions.source(id);
      }
    } else if (event.ctrlKey || event.metaKey || event.altKey) {
      return;
    } else if (event.key === "+" || event.key === "=") {
      this.larger();
      this.revealFocused();
    } else if (event.key === "-") {
      this.smaller();
      this.revealFocused();
    } else if (event.key === "0") {
      this.fit();
    } else {
      return;
    }
    event.preventDefault();
  }

  /** One pointer moves the diagram, two enlarge it. */
  private drag(down: PointerEvent): void {
    if (this.pointers.size === 0) {
      this.dragged = false;
    }
    this.pointers.set(down.pointerId, down);
    const [left, top] = [this.room.scrollLeft, this.room.scrollTop];
    const move = (event: PointerEvent) => {
      const before = this.pointers.get(event.pointerId);
      if (event.pointerId !== down.pointerId || before === undefined) {
        return;
      }
      const other = [...this.pointers.values()].find((each) => each.pointerId !== event.pointerId);
      this.pointers.set(event.pointerId, event);
      if (other !== undefined) {
        this.dragged = true;
        const apart = (one: PointerEvent) => Math.hypot(one.clientX - other.clientX, one.clientY - other.clientY);
        const centre = { clientX: (event.clientX + other.clientX) / 2, clientY: (event.clientY + other.clientY) / 2 };
        this.zoomAt(apart(event) / Math.max(apart(before), 1), centre);
        return;
      }
      const [dx, dy] = [event.clientX - down.clientX, event.clientY - down.clientY];
      this.dragged ||= Math.hypot(dx, dy) > 4;
      if (this.dragged && down.pointerType !== "touch") {
        this.room.scrollTo(left - dx, top - dy);
      }
    };
    const end = (event: PointerEvent) => {
      if (event.pointerId === down.pointerId) {
        this.pointers.delete(down.pointerId);
        window.removeEventListener("pointermove", move);
        window.removeEventListener("pointerup", end);
        window.removeEventListener("pointercancel", end);
      }
    };
    window.addEventListener("pointermove", move);
    window.addEventListener("pointerup", end);
    window.addEventListener("pointercancel", end);
  }
}
