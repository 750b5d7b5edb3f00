"""From text to syntax tree, and back to text in the standard format."""
