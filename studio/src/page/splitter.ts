/** The border between the text and the rest, which moves: by the pointer, by arrow keys, back by a double click. */

const PLACE = "cspdiag-text-share";
const [LEAST, MOST] = [0.35, 2.2];

/** How wide the text is compared with what is beside it; what is stored elsewhere is none. */
export function share(text: string | null): number {
  const found = Number(text ?? "1");
  return Number.isFinite(found) && found > 0 ? Math.min(MOST, Math.max(LEAST, found)) : 1;
}

export function splitter(border: HTMLElement, layout: HTMLElement): void {
  let present = 1;
  const move = (wanted: number) => {
    present = share(String(wanted));
    layout.style.setProperty("--text-share", `${present}fr`);
    border.setAttribute("aria-valuenow", String(Math.round(present * 100)));
  };
  const keep = () => {
    try {
      localStorage.setItem(PLACE, String(present));
    } catch {
      // A browser that stores nothing for pages.
    }
  };
  try {
    move(share(localStorage.getItem(PLACE)));
  } catch {
    move(1);
  }
  border.addEventListener("pointerdown", (down) => {
    border.setPointerCapture(down.pointerId);
    const [from, text] = [present, border.offsetLeft];
    const drag = (event: PointerEvent) => {
      const by = event.clientX - down.clientX;
      const rest = layout.clientWidth - text;
      move(from * ((text + by) / text) * (rest / Math.max(rest - by, 1)));
    };
    border.addEventListener("pointermove", drag);
    border.addEventListener("lostpointercapture", () => {
      border.removeEventListener("pointermove", drag);
      keep();
    }, { once: true });
    down.preventDefault();
  });
  border.addEventListener("dblclick", () => {
    move(1);
    keep();
  });
  border.addEventListener("keydown", (event) => {
    const by = event.key === "ArrowRight" ? 1.1 : event.key === "ArrowLeft" ? 1 / 1.1 : 1;
    if (by !== 1) {
      move(present * by);
      keep();
      event.preventDefault();
    }
  });
}
