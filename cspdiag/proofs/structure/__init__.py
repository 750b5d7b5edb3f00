"""What all proof methods know of a system: which pairs of processes communicate, which wait for each other, and which
cannot do so forever.
"""
