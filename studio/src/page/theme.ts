/** Light or dark: as the system prefers, until one chooses. */

import { element } from "./dom";

const KEY = "cspdiag-theme";

function stored(): string {
  try {
    return localStorage.getItem(KEY) ?? "auto";
  } catch {
    return "auto";
  }
}

export function theme(changed: () => void): void {
  const select = element("theme", HTMLSelectElement);
  const apply = (name: string) => {
    document.documentElement.dataset["theme"] = name;
    changed();
  };
  select.value = stored();
  apply(select.value);
  select.addEventListener("change", () => {
    try {
      localStorage.setItem(KEY, select.value);
    } catch {
      // Where nothing may be stored the choice holds until the page is left.
    }
    apply(select.value);
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", changed);
}
