"""From text to syntax tree, and back in the one style."""
