"""The executable meaning of the language: an interpreter of the network, to be read beside ``docs/language.md``.

It is slow and plain. Docstrings name the sections and paragraphs that the code states, «between guillemets». The
runtime and the C kernel, which are written for speed, share nothing with it; the conformance kit compares them with it.
Fusion follows it at compile time.
"""
