/** On narrow screens one part of the page at a time; the tabs choose it. */

const TABS = '[role="tab"]';

/** The tabs of a list: arrow keys move between them; `chosen` gets what their `data-view` says. */
export function tabs(list: HTMLElement, chosen: (view: string) => void): (view: string) => void {
  const all = [...list.querySelectorAll<HTMLElement>(TABS)];
  const choose = (view: string) => {
    for (const tab of all) {
      const selected = tab.dataset["view"] === view;
      tab.setAttribute("aria-selected", String(selected));
      tab.tabIndex = selected ? 0 : -1;
    }
    chosen(view);
  };
  for (const [index, tab] of all.entries()) {
    tab.addEventListener("click", () => choose(tab.dataset["view"] ?? ""));
    tab.addEventListener("keydown", (event) => {
      const by = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
      if (by !== 0) {
        const next = all[(index + by + all.length) % all.length];
        choose(next?.dataset["view"] ?? "");
        next?.focus();
        event.preventDefault();
      }
    });
  }
  return choose;
}
