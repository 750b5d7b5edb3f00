"""What the text leaves open: kinds of channels, sample periods, reading ends."""
