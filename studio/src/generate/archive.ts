/** Generated files as an archive, which every system can unpack. */

import { strToU8, zipSync } from "fflate";

/** The target whose archive is itself what other tools open. */
const FMU = "fmu";

export interface Archive {
  name: string;
  content: Uint8Array<ArrayBuffer>;
  /** What to do with it, if that needs a word. */
  advice: string;
}

/** The archive of a program with this name for a target: a folder with the files, or an FMU. */
export function archive(files: Readonly<Record<string, string>>, program: string, target: string): Archive {
  const folder = target === FMU ? "" : `${program}-${target}/`;
  const entries = Object.entries(files).map(([path, text]) => [folder + path, strToU8(text)] as const);
  const content = zipSync(Object.fromEntries(entries));
  if (target !== FMU) {
    return { name: `${program}-${target}.zip`, content, advice: "" };
  }
  const name = `${program}.fmu`;
  const advice = `${name} has the sources. \`fmpy compile ${name}\` adds the binary of a machine, which most tools need; \`cspdiag compile\` makes both at once.`;
  return { name, content, advice };
}
