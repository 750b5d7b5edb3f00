"""An oracle for small programs: an explorer of exact time and values, written from docs/language.md alone.

It shares nothing with what it judges. Programs are generated as trees of its own (`tree`, `generate`), printed as text
for cspdiag (`text`), and run by an interpreter of its own (`link`, `machine`) in one way (`page_run`) or in all ways
that the language allows (`explore`). `python -m tests.oracle.hunt` compares the answers.
"""
