/** Files as a tar archive (POSIX ustar), which every system can unpack. */

const BLOCK = 512;

/** Name and prefix of a path: at most 100 and 155 bytes. Raises an Error for a path that is longer. */
function split(path: string): [name: string, prefix: string] {
  if (path.length <= 100) {
    return [path, ""];
  }
  const at = path.indexOf("/", path.length - 101);
  if (at < 0 || at > 155) {
    throw new Error(`the path of ${path} is too long for an archive`);
  }
  return [path.slice(at + 1), path.slice(0, at)];
}

function header(path: string, size: number): Uint8Array {
  const block = new Uint8Array(BLOCK);
  const put = (text: string, at: number) => block.set(new TextEncoder().encode(text), at);
  const octal = (value: number, digits: number) => value.toString(8).padStart(digits, "0");
  const [name, prefix] = split(path);
  put(name, 0);
  put(`${octal(0o644, 7)}\0${octal(0, 7)}\0${octal(0, 7)}\0${octal(size, 11)}\0${octal(0, 11)}\0        0`, 100);
  put("ustar\0" + "00", 257);
  put(prefix, 345);
  const sum = block.reduce((all, byte) => all + byte, 0);
  put(`${octal(sum, 6)}\0 `, 148);
  return block;
}

export function archive(files: Readonly<Record<string, string>>): Uint8Array<ArrayBuffer> {
  const blocks = Object.entries(files).flatMap(([path, text]) => {
    const content = new TextEncoder().encode(text);
    const padded = new Uint8Array(Math.ceil(content.length / BLOCK) * BLOCK);
    padded.set(content);
    return [header(path, content.length), padded];
  });
  const end = new Uint8Array(2 * BLOCK);
  const whole = new Uint8Array([...blocks, end].reduce((all, block) => all + block.length, 0));
  let at = 0;
  for (const block of [...blocks, end]) {
    whole.set(block, at);
    at += block.length;
  }
  return whole;
}
