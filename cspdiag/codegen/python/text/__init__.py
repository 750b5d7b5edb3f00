"""Python as text: expressions, statements, names, imports, layout."""
