"""Files that commands write: whole or not at all, never over what was made by hand, and refused before
the work.
"""
