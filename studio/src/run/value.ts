/** A value as one reads it: a struct as the language builds it, an array in brackets. */

export function text(value: unknown): string {
  if (typeof value === "number") {
    return String(Number(value.toPrecision(5)));
  }
  if (Array.isArray(value)) {
    return `[${value.map(text).join(", ")}]`;
  }
  if (typeof value === "object" && value !== null) {
    return `(${Object.entries(value).map(([name, part]) => `${name} = ${text(part)}`).join(", ")})`;
  }
  return typeof value === "string" || typeof value === "boolean" ? String(value) : "–";
}
