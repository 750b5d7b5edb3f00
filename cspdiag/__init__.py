"""cspdiag: communication and composition diagrams in text, checked and turned into control software that runs."""

__version__ = "0.1.0"
