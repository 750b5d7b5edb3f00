"""What proving takes at a command: a time limit that is kept, a memory of what was proved, and how answers
are printed.
"""
