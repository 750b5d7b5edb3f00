"""Construction of the nodes of the syntax tree from the rules that the parser recognizes."""
