"""The struct of a process class: what it has in it, and how it is laid out."""
