"""Text to tokens, and the tables of the parser."""
