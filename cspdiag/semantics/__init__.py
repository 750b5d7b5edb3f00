"""The executable meaning of the language: an interpreter of the network, slow and plain, to be read beside ``docs/language.md``.

Every docstring names the section that the code states, between guillemets. The runtime and the C kernel, which are written for speed, share
nothing with it; the conformance kit compares them with it.
"""
