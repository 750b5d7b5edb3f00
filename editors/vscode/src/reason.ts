/** Why something failed, in words. Nothing here knows VS Code, so that it can be tested alone. */

/** The reason in an error, without the names of classes, calls and programs around it. */
export function reasonOf(problem: unknown): string {
  const message = (problem instanceof Error ? problem.message : String(problem)).trim();
  // Such as "NoPermissions (FileSystem): Error: EROFS: read-only file system, open '/folder/file'".
  const system = /\bE[A-Z]{2,}: ([^,]+)/.exec(message);
  return system?.[1] ?? message.replace(/^(?:\w*Error: )?(?:cspdiag: )?/, "");
}
