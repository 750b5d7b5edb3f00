/** A program as the fragment of a link: `#code=` and base64url of the deflated JSON. */

import type { Program } from "../engine/messages";

const LONGEST = 4_000_000;

async function through(bytes: Uint8Array<ArrayBuffer>, stream: CompressionStream | DecompressionStream): Promise<Uint8Array<ArrayBuffer>> {
  const piped = new Blob([bytes]).stream().pipeThrough(stream);
  return new Uint8Array(await new Response(piped).arrayBuffer());
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
  const code = /^#code=([A-Za-z0-9_-]*)$/.exec(fragment)?.[1];
  if (code === undefined) {
    return undefined;
  }
  let found: unknown;
  try {
    const bytes = Uint8Array.from(atob(code.replaceAll("-", "+").replaceAll("_", "/")), (letter) => letter.charCodeAt(0));
    const text = await through(bytes, new DecompressionStream("deflate-raw"));
    found = text.length > LONGEST ? undefined : JSON.parse(new TextDecoder().decode(text));
  } catch {
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
