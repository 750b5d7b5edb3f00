"""What all methods of proof know of a system: which pairs of processes meet, wait for each other, and cannot do so for
ever.
"""
