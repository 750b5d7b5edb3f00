/** A program as the fragment of a link: `#code=` and base64url of the deflated JSON. */

import type { Program } from "../engine/messages";

const LONGEST = 4_000_000;

/** What comes out of a stream of which no more than `most` bytes are wanted: a short link can hold any number of them. */
async function through(bytes: Uint8Array<ArrayBuffer>, stream: CompressionStream | DecompressionStream, most = Infinity): Promise<Uint8Array<ArrayBuffer>> {
  const reader = new Blob([bytes]).stream().pipeThrough(stream).getReader();
  const pieces: Uint8Array<ArrayBuffer>[] = [];
  let length = 0;
  for (let next = await reader.read(); !next.done; next = await reader.read()) {
    pieces.push(next.value);
    length += next.value.length;
    if (length > most) {
      await reader.cancel();
      throw new TooLargeError();
    }
  }
  return new Uint8Array(await new Blob(pieces).arrayBuffer());
}

class TooLargeError extends Error {
  constructor() {
    super(`the program in this link is too large: ${LONGEST / 1e6} MB are shown at most`);
  }
}

export async function encoded(program: Program): Promise<string> {
  const text = JSON.stringify({ files: program.files, main: program.main });
  const bytes = await through(new TextEncoder().encode(text), new CompressionStream("deflate-raw"));
  let binary = "";
  for (const byte of bytes) {
    binary += String.fromCharCode(byte);
  }
  return `#code=${btoa(binary).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "")}`;
}

/** The program in a fragment; undefined if there is none. Raises an Error if what is there is damaged. */
export async function decoded(fragment: string): Promise<Program | undefined> {
  const start = "#code=";
  if (!fragment.startsWith(start)) {
    return undefined;
  }
  const code = fragment.slice(start.length);
  let found: unknown;
  try {
    const bytes = Uint8Array.from(atob(code.replaceAll("-", "+").replaceAll("_", "/")), (letter) => letter.charCodeAt(0));
    found = JSON.parse(new TextDecoder().decode(await through(bytes, new DecompressionStream("deflate-raw"), LONGEST)));
  } catch (problem) {
    if (problem instanceof TooLargeError) {
      throw problem;
    }
    found = undefined;
  }
  if (!isProgram(found)) {
    throw new Error("the program in this link is damaged: copy the whole link again");
  }
  return found;
}

function isProgram(found: unknown): found is Program {
  if (typeof found !== "object" || found === null || !("files" in found) || !("main" in found)) {
    return false;
  }
  const { files, main } = found;
  if (typeof files !== "object" || files === null || typeof main !== "string") {
    return false;
  }
  return Object.hasOwn(files, main) && Object.values(files).every((text) => typeof text === "string");
}
