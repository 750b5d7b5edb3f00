"""From what the parser has found to the syntax tree."""
