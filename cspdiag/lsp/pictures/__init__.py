"""Diagrams for editors, drawn in a process of their own."""
