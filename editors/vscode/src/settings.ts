/** The values of settings. Nothing here knows VS Code, so that it can be tested alone. */

/** A setting that is a text; a value of another type, which the settings do not prevent, as it is written there. */
export function textOf(value: unknown): string {
  return typeof value === "string" ? value : JSON.stringify(value ?? null);
}
