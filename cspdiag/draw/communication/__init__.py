"""Communication diagrams as pictures."""
