"""The language server: what an editor asks about programs while they are written."""
