"""The lexer, the parse tables, and recovery from errors."""
