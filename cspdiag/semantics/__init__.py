"""The executable semantics of the language: an interpreter of the network, to be read together with
``docs/language.md``.

It is slow and simple. Docstrings name the sections and paragraphs of the reference that the code implements, «between
guillemets». The runtime and the C kernel, which are written for speed, share no code with it; the conformance kit
compares them with it. Fusion runs it at compile time.
"""
