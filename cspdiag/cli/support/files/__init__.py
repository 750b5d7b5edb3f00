"""Files that commands write: completely or not at all, never over files made by hand, and refused before the work."""
