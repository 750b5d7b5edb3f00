"""C as text: expressions, types, names, lines."""
