"""What the language server answers, a module for each feature of the protocol."""
