"""Whether a network is what passes and targets take for granted."""
