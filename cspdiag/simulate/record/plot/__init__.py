"""Pictures of recordings: a place of its own for every part and port."""
