"""Process classes in C: structs, step functions and all that a composition becomes."""
