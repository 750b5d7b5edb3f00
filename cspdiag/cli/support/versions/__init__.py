"""The versions of programs that are compared: files, and revisions of git."""
