/** Elements of the page; texts become text, never HTML. */

type Child = Node | string | undefined;

/** An element with attributes and children; an attribute that is undefined is left out. */
export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Record<string, string | undefined> = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value !== undefined) {
      made.setAttribute(name, value);
    }
  }
  made.append(...children.filter((child) => child !== undefined));
  return made;
}

/** A button that acts. */
export function button(
  label: string | Child[],
  act: () => void,
  attributes: Record<string, string | undefined> = {},
): HTMLButtonElement {
  const made = h("button", { type: "button", ...attributes }, ...(typeof label === "string" ? [label] : label));
  made.addEventListener("click", act);
  return made;
}

/**
 * The element of the page with an identifier, which is written with `ui-` before it: those of diagrams are others.
 * Raises an Error if it is missing or of another type.
 */
export function element<T extends Element>(id: string, type: abstract new () => T): T {
  const found = document.getElementById(`ui-${id}`);
  if (!(found instanceof type)) {
    throw new Error(`the page has no ${id}`);
  }
  return found;
}

/** Shows choices, and keeps the chosen one if it is still there. */
export function options(select: HTMLSelectElement, choices: readonly (readonly [value: string, label: string])[]): void {
  const before = select.value;
  select.replaceChildren(...choices.map(([value, label]) => new Option(label, value)));
  if (choices.some(([value]) => value === before)) {
    select.value = before;
  }
}

/** Calls once, when nothing asked for it again for some milliseconds. */
export function settled(wait: number, act: () => void): () => void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  return () => {
    clearTimeout(timer);
    timer = setTimeout(act, wait);
  };
}
